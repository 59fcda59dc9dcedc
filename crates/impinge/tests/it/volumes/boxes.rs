//! The three forms of a box and their packed forms: no conversion shrinks a box, and boxes that
//! overlap are never reported apart.

use impinge::volume::{
    Aabb, BoundingVolume, CenterRadius, MinMax, MinWidths, PackedCenterRadius, PackedMinWidths, Steps,
};
use impinge_testkit::generate::Rng;

use crate::volumes::exact::{Exact, point};
use crate::volumes::points::{KINDS, cloud};

fn holds_box(outer: &impl Exact, inner: &impl Exact) {
    for corner in inner.witnesses() {
        assert!(outer.holds(&corner), "{outer:?} lacks a corner of {inner:?}");
    }
}

#[test]
fn no_chain_of_conversions_shrinks() {
    let mut rng = Rng::new(31);
    let mut kept = 0;
    for round in 0..400 {
        let bounds = MinMax::of(&cloud(&mut rng, KINDS[round % 8], 5)).unwrap();
        let widths = MinWidths::from(bounds);
        holds_box(&widths, &bounds);
        let back = MinMax::from(widths);
        holds_box(&back, &widths);
        let radius = CenterRadius::from(back);
        holds_box(&radius, &back);
        let again = MinMax::from(radius);
        holds_box(&again, &radius);
        let single = MinMax::from_aabb(&again.to_aabb()).unwrap();
        assert!(single.encloses(&again) && single.encloses(&bounds));
        packed_chain::<u8>(&bounds);
        packed_chain::<u16>(&bounds);
        kept += usize::from(again == bounds);
    }
    assert!(kept > 100, "{kept} of 400 chains are unchanged, as those on a grid must be");
}

/// Checks packed forms: they contain the original box, decode exactly, and stay tight. A step is a
/// power of two below 2 / MOST of the longest extent.
fn packed_chain<T: Steps>(bounds: &MinMax) {
    let (widths, radius) = (MinWidths::from(*bounds), CenterRadius::from(*bounds));
    let packed = PackedMinWidths::<T>::try_from(widths).unwrap();
    let decoded = MinWidths::from(packed);
    holds_box(&decoded, &widths);
    holds_box(&MinMax::from(packed), &decoded);
    assert_eq!(
        PackedMinWidths::<T>::try_from(decoded).unwrap().volume(),
        packed.volume(),
        "packing again changes nothing"
    );
    let centerd = PackedCenterRadius::<T>::try_from(radius).unwrap();
    let decoded_radius = CenterRadius::from(centerd);
    holds_box(&decoded_radius, &radius);
    holds_box(&MinMax::from(centerd), &decoded_radius);
    let longest = widths.widths().into_iter().fold(0.0, f64::max);
    // The rounding error of a corner in single precision.
    let corner = bounds.min().into_iter().chain(bounds.max()).fold(0.0_f64, |far, x| far.max(2.4e-7 * x.abs()));
    for k in 0..3 {
        let step = 2.0 * (longest + corner) / f64::from(T::MOST) + 1e-38;
        assert!(decoded.widths()[k] <= widths.widths()[k] + 2.0 * step + corner, "{decoded:?} {bounds:?}");
        assert!(
            decoded_radius.half_extents()[k] <= radius.half_extents()[k] + 2.0 * step + corner,
            "{decoded_radius:?}"
        );
    }
}

#[test]
fn overlap_tests_of_all_forms_are_right() {
    let mut rng = Rng::new(32);
    let (mut met, mut close) = (0, 0);
    for round in 0..2000 {
        let draw = Draw::new(&mut rng);
        let (a, mut b) = (draw.any_box(&mut rng), draw.any_box(&mut rng));
        if round % 2 == 0 {
            // Touching on one axis: exactly, one float short of it, or one float over.
            let axis = rng.integer(0, 2) as usize;
            let mut min = b.min();
            min[axis] = rng.choose(&[a.max()[axis], a.max()[axis].next_up(), a.max()[axis].next_down()]);
            let max = std::array::from_fn(|k| b.max()[k].max(min[k]));
            b = MinMax::new(min, max).unwrap();
            close += 1;
        }
        let truth = have_common_point(&a, &b);
        met += usize::from(truth);
        assert_eq!(a.overlaps(&b), truth);
        let (p, q) = (MinWidths::from(a), MinWidths::from(b));
        assert_eq!(p.overlaps(&q), have_common_point(&p, &q), "{p:?} {q:?}");
        let (p, q) = (CenterRadius::from(a), CenterRadius::from(b));
        assert!(p.overlaps(&q) || !have_common_point(&p, &q), "{p:?} {q:?}");
        packed_overlap::<u8>(&a, &b);
        packed_overlap::<u16>(&a, &b);
    }
    assert!((600..1600).contains(&met) && close == 1000, "{met} of 2000 have_common_point");
}

fn packed_overlap<T: Steps>(a: &MinMax, b: &MinMax) {
    let pack = |bounds: &MinMax| PackedMinWidths::<T>::try_from(MinWidths::from(*bounds)).unwrap();
    let (p, q) = (pack(a), pack(b));
    assert_eq!(p.overlaps(&q), have_common_point(&MinWidths::from(p), &MinWidths::from(q)));
    assert!(p.overlaps(&q) || !have_common_point(a, b));
    holds_box(&MinWidths::from(p.merged(&q).unwrap()), a);
    let pack = |bounds: &MinMax| PackedCenterRadius::<T>::try_from(CenterRadius::from(*bounds)).unwrap();
    let (p, q) = (pack(a), pack(b));
    assert!(p.overlaps(&q) || !have_common_point(&CenterRadius::from(p), &CenterRadius::from(q)));
    assert!(p.overlaps(&q) || !have_common_point(a, b));
    holds_box(&CenterRadius::from(p.merged(&q).unwrap()), b);
}

/// Reports whether two boxes have a common point: no axis separates all corners of one box from
/// those of the other.
fn have_common_point<V: Exact>(a: &V, b: &V) -> bool {
    let (p, q) = (a.witnesses(), b.witnesses());
    (0..3).all(|k| {
        let ends = |points: &[crate::volumes::exact::Point]| {
            let on_axis = || points.iter().map(|p| p[k].clone());
            (on_axis().min().unwrap(), on_axis().max().unwrap())
        };
        let ((a_low, a_high), (b_low, b_high)) = (ends(&p), ends(&q));
        a_low <= b_high && b_low <= a_high
    })
}

#[test]
fn containment_agrees_with_rationals() {
    let mut rng = Rng::new(33);
    let (mut inside, mut enclosed) = (0, 0);
    for _ in 0..2000 {
        let draw = Draw::new(&mut rng);
        let (a, b) = (draw.any_box(&mut rng), draw.any_box(&mut rng));
        let p: [f64; 3] =
            std::array::from_fn(|k| rng.choose(&[a.min()[k], a.max()[k], a.max()[k].next_up(), b.min()[k]]));
        assert_eq!(a.contains(p), a.holds(&point(p)));
        let (widths, radius) = (MinWidths::from(a), CenterRadius::from(a));
        assert_eq!(widths.contains(p), widths.holds(&point(p)));
        assert_eq!(radius.contains(p), radius.holds(&point(p)));
        let truth = b.witnesses().iter().all(|corner| a.holds(corner));
        assert_eq!(a.encloses(&b), truth);
        let of_widths = MinWidths::from(b);
        assert!(!widths.encloses(&of_widths) || of_widths.witnesses().iter().all(|corner| widths.holds(corner)));
        let of_radius = CenterRadius::from(b);
        assert!(!radius.encloses(&of_radius) || of_radius.witnesses().iter().all(|corner| radius.holds(corner)));
        inside += usize::from(a.contains(p));
        enclosed += usize::from(truth);
    }
    assert!(inside > 300 && enclosed > 30, "{inside} inside, {enclosed} enclosed");
}

#[test]
fn volume_and_surface_area_are_those_of_the_box() {
    let bounds = MinMax::new([1.0; 3], [2.0, 3.0, 4.0]).unwrap();
    assert_eq!((bounds.volume(), bounds.surface_area()), (6.0, 22.0));
    let (widths, radius) = (MinWidths::from(bounds), CenterRadius::from(bounds));
    assert_eq!((widths.volume(), widths.surface_area()), (6.0, 22.0));
    assert_eq!((radius.volume(), radius.surface_area()), (6.0, 22.0));
    assert_eq!(MinMax::from_aabb(&Aabb::EMPTY), None);
}

#[test]
fn tiny_and_huge_boxes_are_packed() {
    for size in [5e-324, 1e-45, 1e-38, 1.0, 1e37] {
        let bounds = MinMax::new([-size, 0.0, size], [size, size, size]).unwrap();
        packed_holds::<u8>(&bounds);
        packed_holds::<u16>(&bounds);
        assert!(MinMax::from_aabb(&bounds.to_aabb()).unwrap().encloses(&bounds));
    }
    let huge = MinWidths::new([0.0; 3], [1e39; 3]).unwrap();
    let error = PackedMinWidths::<u8>::try_from(huge).unwrap_err();
    assert!(error.to_string().contains("2^127"), "{error}");
}

fn packed_holds<T: Steps>(bounds: &MinMax) {
    holds_box(&MinMax::from(PackedMinWidths::<T>::try_from(MinWidths::from(*bounds)).unwrap()), bounds);
    holds_box(&MinMax::from(PackedCenterRadius::<T>::try_from(CenterRadius::from(*bounds)).unwrap()), bounds);
}

/// Offset and size shared by the boxes of a pair. Half of the pairs are on a grid.
struct Draw {
    offset: f64,
    size: f64,
    grid: bool,
}

impl Draw {
    fn new(rng: &mut Rng) -> Self {
        Self { offset: rng.choose(&[0.0, 0.0, 1e7]), size: rng.choose(&[1.0, 1e-6, 1e6]), grid: rng.one_in(2) }
    }

    fn any_box(&self, rng: &mut Rng) -> MinMax {
        let number = |rng: &mut Rng| if self.grid { rng.integer(-2, 2) as f64 } else { rng.uniform(-2.0, 2.0) };
        let ends: [[f64; 2]; 3] = std::array::from_fn(|_| {
            let (s, t) = (self.offset + self.size * number(rng), self.offset + self.size * number(rng));
            [s.min(t), s.max(t)]
        });
        MinMax::new(ends.map(|[low, _]| low), ends.map(|[_, high]| high)).unwrap()
    }
}
