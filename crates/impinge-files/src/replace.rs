//! Writes files atomically: no reader ever sees a part of a file.

use std::fs::{self, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::Builder;

/// Size of the buffer between the content and the file, in bytes.
const BUFFER: usize = 1 << 16;

/// Writes a file, or replaces an existing one.
///
/// The content is written to a temporary file in the same folder, which is renamed when it is
/// complete. So the old file is unchanged until then, also if writing fails. Processes that have
/// the old file open or mapped keep it. If two threads write to the same path, the file of one of
/// them remains. The new file has the permissions of the old one. If the path is a symbolic link,
/// the file that it leads to is replaced.
///
/// A path that is not a regular file, such as a pipe, is written in place. So is `/dev/stdout`, to
/// which the content is appended.
///
/// ```
/// # let folder = tempfile::tempdir()?;
/// let path = folder.path().join("pairs.csv");
/// impinge_files::replace_file(&path, |out| out.write_all(b"a,b\n"))?;
/// let failed = impinge_files::replace_file(&path, |out| {
///     out.write_all(b"half a ")?;
///     Err(std::io::Error::other("the rest is missing"))
/// });
/// assert!(failed.is_err());
/// assert_eq!(std::fs::read(&path)?, b"a,b\n");
/// # Ok::<(), std::io::Error>(())
/// ```
///
/// # Errors
/// Returns an error if `content` does, if the file cannot be written, or if the temporary file
/// cannot be created.
pub fn replace_file(path: impl AsRef<Path>, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let path = path.as_ref();
    if is_stream(path) {
        return fill(OpenOptions::new().append(true).open(path)?, content);
    }
    let real = behind_links(path);
    let old = fs::metadata(&real).ok();
    if old.is_some() {
        // Renaming needs only permission to write to the folder, so check separately that the file
        // may be written.
        let file = OpenOptions::new().write(true).open(&real)?;
        if !file.metadata()?.is_file() {
            return fill(file, content);
        }
    }
    let folder = real.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = Builder::new();
    builder.prefix(".impinge-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The system removes the bits that the user's mask forbids.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let beside = builder.tempfile_in(folder).map_err(|error| without_name(&error, folder))?;
    if let Some(old) = old {
        beside.as_file().set_permissions(old.permissions())?;
    }
    fill(beside.as_file(), content)?;
    beside.persist(&real).map_err(|error| error.error)?;
    Ok(())
}

/// Reports whether a path is a stream that this process already has open. It may lead to a file to
/// which other parts of the process write.
fn is_stream(path: &Path) -> bool {
    cfg!(unix) && (["/dev/stdout", "/dev/stderr"].map(Path::new).contains(&path) || path.starts_with("/dev/fd"))
}

/// Returns the path behind symbolic links, also if there is no file yet.
fn behind_links(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| {
        let folder = path.parent().unwrap_or(Path::new(""));
        fs::read_link(path).map_or_else(|_| path.to_owned(), |target| folder.join(target))
    })
}

/// Writes the content through a buffer.
fn fill(file: impl Write, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(BUFFER, file);
    content(&mut out)?;
    out.flush()
}

/// Returns the error without the name of the temporary file, which no user knows.
fn without_name(error: &io::Error, folder: &Path) -> io::Error {
    match error.kind() {
        kind @ io::ErrorKind::NotFound => {
            io::Error::new(kind, format!("the folder {} does not exist", folder.display()))
        }
        kind => kind.into(),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use tempfile::TempDir;

    use super::*;

    fn write(path: &Path, text: &str) -> io::Result<()> {
        replace_file(path, |out| out.write_all(text.as_bytes()))
    }

    #[test]
    fn a_new_file_has_default_permissions() {
        let folder = TempDir::new().unwrap();
        let [ours, other] = ["ours", "other"].map(|name| folder.path().join(name));
        write(&ours, "text").unwrap();
        fs::write(&other, "text").unwrap();
        assert_eq!(ours.metadata().unwrap().permissions(), other.metadata().unwrap().permissions());
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 2, "nothing is left beside it");
    }

    #[test]
    fn readers_of_the_old_file_keep_it() {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("file");
        write(&path, "old").unwrap();
        let old = fs::File::open(&path).unwrap();
        write(&path, "new and longer").unwrap();
        assert_eq!(io::read_to_string(old).unwrap(), "old");
        assert_eq!(fs::read_to_string(&path).unwrap(), "new and longer");
    }

    #[test]
    fn a_missing_folder_is_named() {
        let error = write(Path::new("no/such/folder/file"), "").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::NotFound);
        assert_eq!(error.to_string(), "the folder no/such/folder does not exist");
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_are_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = TempDir::new().unwrap();
        let [path, link] = ["file", "link"].map(|name| folder.path().join(name));
        write(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("file", &link).unwrap();
        write(&link, "new").unwrap();
        assert!(link.symlink_metadata().unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(path.metadata().unwrap().permissions().mode() & 0o777, 0o640);
        write(Path::new("/dev/null"), "a device is written in place").unwrap();
        let [dangling, target] = ["dangling", "target"].map(|name| folder.path().join(name));
        symlink("target", &dangling).unwrap();
        write(&dangling, "a new file").unwrap();
        assert!(dangling.symlink_metadata().unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&target).unwrap(), "a new file");
    }

    #[test]
    fn concurrent_writes_to_one_path_all_succeed() {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("file");
        let texts: Vec<String> = (0..8).map(|i| i.to_string().repeat(100_000 + i)).collect();
        std::thread::scope(|scope| {
            for text in &texts {
                scope.spawn(|| {
                    for _ in 0..20 {
                        write(&path, text).unwrap();
                        assert!(texts.contains(&fs::read_to_string(&path).unwrap()));
                    }
                });
            }
        });
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
    }
}
