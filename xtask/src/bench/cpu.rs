//! Short names of processors, which name the files of records.

use std::fs;

/// Processors of records: the short name, and the name that pages show.
const NAMES: [(&str, &str); 10] = [
    ("emerald-rapids", "Intel Xeon (Emerald Rapids)"),
    ("epyc", "AMD EPYC of an unrecorded generation"),
    ("ice-lake", "Intel Xeon (Ice Lake)"),
    ("sapphire-rapids", "Intel Xeon (Sapphire Rapids)"),
    ("skylake", "Intel Xeon (Skylake or Cascade Lake)"),
    ("xeon-2.5ghz", "Intel Xeon at 2.5 GHz"),
    ("zen2", "AMD EPYC (Zen 2)"),
    ("zen3", "AMD EPYC (Zen 3)"),
    ("zen4", "AMD EPYC (Zen 4)"),
    ("zen5", "AMD EPYC (Zen 5)"),
];

/// Returns the name of a processor for pages. An unknown processor is shown by its short name.
pub(crate) fn name(slug: &str) -> &str {
    NAMES.iter().find(|(known, _)| *known == slug).map_or(slug, |(_, name)| name)
}

/// Returns the short name of the processor of this machine.
///
/// On systems without `/proc/cpuinfo` it is the architecture.
pub(crate) fn slug() -> String {
    fs::read_to_string("/proc/cpuinfo").map_or_else(|_| std::env::consts::ARCH.to_owned(), |text| slug_of(&text))
}

/// Returns the short name of the processor that the text of `/proc/cpuinfo` describes.
///
/// Virtual machines hide the model behind a name such as `AMD EPYC`. So the family and the model
/// number decide, and the name only if they are not in the table.
fn slug_of(cpuinfo: &str) -> String {
    let field = |wanted: &str| {
        let mut fields = cpuinfo.lines().filter_map(|line| line.split_once(':'));
        fields.find(|(key, _)| key.trim() == wanted).map_or("", |(_, value)| value.trim())
    };
    let model_name = field("model name");
    if model_name.ends_with("Xeon(R) Processor @ 2.50GHz") {
        return "xeon-2.5ghz".to_owned();
    }
    let number = |wanted| field(wanted).parse().unwrap_or(0);
    let known = generation(field("vendor_id"), number("cpu family"), number("model"));
    known.map_or_else(|| slug_of_name(model_name), str::to_owned)
}

/// Returns the generation of a server processor by its family and model, as the Linux kernel lists
/// them in `arch/x86/kernel/cpu/amd.c` and `arch/x86/include/asm/intel-family.h`.
fn generation(vendor: &str, family: u32, model: u32) -> Option<&'static str> {
    match (vendor, family, model) {
        ("AuthenticAMD", 0x17, 0x30..) => Some("zen2"),
        ("AuthenticAMD", 0x19, 0x00..=0x0f | 0x20..=0x5f) => Some("zen3"),
        ("AuthenticAMD", 0x19, 0x10..=0x1f | 0x60..=0x7f | 0xa0..=0xaf) => Some("zen4"),
        ("AuthenticAMD", 0x1a, _) => Some("zen5"),
        ("GenuineIntel", 6, 0x55) => Some("skylake"),
        ("GenuineIntel", 6, 0x6a) => Some("ice-lake"),
        ("GenuineIntel", 6, 0x8f) => Some("sapphire-rapids"),
        ("GenuineIntel", 6, 0xcf) => Some("emerald-rapids"),
        _ => None,
    }
}

/// Returns the name of a model in lower case, with hyphens between its words.
fn slug_of_name(model_name: &str) -> String {
    let lower = model_name.to_lowercase().replace("(r)", "").replace("(tm)", "");
    let words = lower.split(|c: char| !c.is_ascii_alphanumeric() && c != '.').map(|word| word.trim_matches('.'));
    let kept: Vec<&str> = words.filter(|word| !matches!(*word, "" | "cpu" | "processor" | "core")).collect();
    if kept.is_empty() { std::env::consts::ARCH.to_owned() } else { kept.join("-") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cpuinfo(vendor: &str, family: u32, model: u32, name: &str) -> String {
        format!(
            "processor\t: 0\nvendor_id\t: {vendor}\ncpu family\t: {family}\nmodel\t\t: {model}\nmodel name\t: {name}\n"
        )
    }

    #[test]
    fn family_and_model_tell_what_virtual_machines_hide() {
        assert_eq!(slug_of(&cpuinfo("AuthenticAMD", 25, 17, "AMD EPYC")), "zen4");
        assert_eq!(slug_of(&cpuinfo("AuthenticAMD", 25, 1, "AMD EPYC")), "zen3");
        assert_eq!(slug_of(&cpuinfo("AuthenticAMD", 26, 2, "AMD EPYC")), "zen5");
        assert_eq!(slug_of(&cpuinfo("GenuineIntel", 6, 207, "Intel(R) Xeon(R) Processor")), "emerald-rapids");
    }

    #[test]
    fn other_processors_are_named_by_their_model() {
        let name = "Intel(R) Xeon(R) Processor @ 2.50GHz";
        assert_eq!(slug_of(&cpuinfo("GenuineIntel", 6, 85, name)), "xeon-2.5ghz");
        let name = "Intel(R) Core(TM) i7-8550U CPU @ 1.80GHz";
        assert_eq!(slug_of(&cpuinfo("GenuineIntel", 6, 142, name)), "intel-i7-8550u-1.80ghz");
        assert_eq!(slug_of(""), std::env::consts::ARCH);
    }

    #[test]
    fn pages_show_known_processors_by_their_names() {
        assert_eq!(name("zen4"), "AMD EPYC (Zen 4)");
        assert_eq!(name("apple-m3"), "apple-m3");
    }
}
