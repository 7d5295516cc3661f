//! Names and numbers on the command line.

use raywood::Vec3;

use crate::peers::PEERS;
use crate::peers::queries::QUERY_PEERS;
use crate::query::sets::QueryKind;
use crate::ray_sets::SetKind;
use crate::scenes::{SCENES, SceneEntry};

/// The entry that is called so.
fn named<T>(items: &[T], name_of: fn(&T) -> &'static str, text: &str) -> Result<T, String>
where
    T: Copy,
{
    items.iter().find(|item| name_of(item) == text).copied().ok_or_else(|| {
        let names: Vec<_> = items.iter().map(name_of).collect();
        format!("expected one of {}", names.join(", "))
    })
}

pub(super) fn scene(text: &str) -> Result<SceneEntry, String> {
    named(SCENES, |scene| scene.name, text)
}

pub(super) fn set(text: &str) -> Result<SetKind, String> {
    named(SetKind::ALL, |set| set.name(), text)
}

pub(super) fn peer(text: &str) -> Result<&'static str, String> {
    named(PEERS, |peer| peer.name, text).map(|peer| peer.name)
}

pub(super) fn query_set(text: &str) -> Result<QueryKind, String> {
    named(QueryKind::ALL, |set| set.name(), text)
}

pub(super) fn query_peer(text: &str) -> Result<&'static str, String> {
    named(QUERY_PEERS, |peer| peer.name, text).map(|peer| peer.name)
}

/// Three finite numbers between commas.
pub(super) fn point(text: &str) -> Result<Vec3, String> {
    let numbers: Vec<_> = text.split(',').map(|part| part.trim().parse::<f32>()).collect();
    match numbers[..] {
        [Ok(x), Ok(y), Ok(z)] if [x, y, z].iter().all(|x| x.is_finite()) => Ok(Vec3::new(x, y, z)),
        _ => Err("expected three numbers, as in 1,2.5,-3".to_owned()),
    }
}

pub(super) fn above_zero(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("expected a number above 0".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_are_read() {
        assert_eq!(set("ao"), Ok(SetKind::AmbientOcclusion));
        let said = set("reflection").expect_err("no such set");
        assert_eq!(said, "expected one of primary, shadow, mirror, ao, diffuse, shuffled");
        assert_eq!(peer("embree"), Ok("embree"));
        assert!(peer("embre").is_err());
        assert_eq!(query_set("surface-near"), Ok(QueryKind::SurfaceNear));
        let said = query_set("near").expect_err("no such set");
        assert_eq!(said, "expected one of surface-near, box, far, crossings");
        assert_eq!(query_peer("parry3d"), Ok("parry3d"));
        assert_eq!(query_peer("embree"), Err("expected one of raywood, parry3d".to_owned()));
        assert_eq!(scene("terrain").map(|scene| scene.name), Ok("terrain"));
        assert!(scene("Terrain").is_err());
        assert_eq!(point("1, -2.5,3e2"), Ok(Vec3::new(1.0, -2.5, 300.0)));
        for bad in ["", "1,2", "1,2,3,4", "1,2,nan", "1,2,x"] {
            assert!(point(bad).is_err(), "{bad}");
        }
        assert!(["0", "-1", "inf", ""].iter().all(|bad| above_zero(bad).is_err()));
    }
}
