//! Values on the command line: points, sizes, lights.

use std::str::FromStr;
use std::time::Duration;

use raywood::{BuildPreset, SimdLevel, StructureKind, Vec3};
use raywood_render::{
    Aov, HeatQuantity, INTEGRATORS, Integrator, PixelFilter, Region, Shutter, TONE_MAPS, ToneMap,
};
use raywood_scene::closest_name;

/// A point or direction, `X,Y,Z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point(pub(crate) Vec3);

impl FromStr for Point {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match numbers(text)?[..] {
            [x, y, z] => Ok(Self(Vec3::new(x, y, z))),
            _ => Err("expected three numbers, as in 1,2.5,-3".to_owned()),
        }
    }
}

/// A point light, `X,Y,Z` or `X,Y,Z,STRENGTH`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PointLight {
    pub(crate) position: Vec3,
    pub(crate) strength: f32,
}

impl FromStr for PointLight {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match numbers(text)?[..] {
            [x, y, z] => Ok(Self { position: Vec3::new(x, y, z), strength: 1.0 }),
            [x, y, z, strength] if strength >= 0.0 => {
                Ok(Self { position: Vec3::new(x, y, z), strength })
            }
            _ => Err("expected a position and perhaps a strength, as in 1,2.5,-3 or 1,2.5,-3,0.5"
                .to_owned()),
        }
    }
}

/// Finite numbers between commas.
fn numbers(text: &str) -> Result<Vec<f32>, String> {
    let number = |part: &str| match part.trim().parse::<f32>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("`{part}` is not a number")),
    };
    text.split(',').map(number).collect()
}

/// The size of a picture in pixels, `WIDTHxHEIGHT`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let complaint = || "expected width and height in pixels, as in 1280x800".to_owned();
        let (width, height) = text.split_once(['x', 'X']).ok_or_else(complaint)?;
        match (width.trim().parse(), height.trim().parse()) {
            (Ok(width), Ok(height)) => Ok(Self { width, height }),
            _ => Err(complaint()),
        }
    }
}

/// A rectangle of pixels, `X,Y,WIDTH,HEIGHT`.
pub(crate) fn region(text: &str) -> Result<Region, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, width, height]) if width > 0 && height > 0 => {
            Ok(Region { x, y, width, height })
        }
        _ => {
            Err("expected column, row, width and height in pixels, as in 640,0,320,200".to_owned())
        }
    }
}

/// One of several shares, `NUMBER/COUNT`, the first of which is 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Share {
    pub(crate) number: u32,
    pub(crate) count: u32,
}

impl FromStr for Share {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(number, count)| {
            Some((number.trim().parse().ok()?, count.trim().parse().ok()?))
        });
        match parts {
            Some((number, count)) if (1..=count).contains(&number) => Ok(Self { number, count }),
            _ => Err("expected a number and how many there are, from 1/1 on, as in 3/8".to_owned()),
        }
    }
}

/// A whole number between two others, both allowed.
pub(crate) fn whole_number(text: &str, least: u32, most: u32) -> Result<u32, String> {
    let number = text.parse().ok().filter(|number| (least..=most).contains(number));
    number.ok_or_else(|| format!("expected a whole number from {least} to {most}"))
}

/// What was found by a name, or else which names there are, and which was probably meant.
fn named<T>(
    text: &str,
    found: Option<T>,
    names: impl IntoIterator<Item = &'static str>,
) -> Result<T, String> {
    found.ok_or_else(|| {
        let names: Vec<_> = names.into_iter().collect();
        let meant = closest_name(text, names.iter().copied());
        let question = meant.map_or(String::new(), |name| format!("did you mean {name}? "));
        format!("{question}expected one of {}", names.join(", "))
    })
}

/// The name of an acceleration structure.
pub(crate) fn structure_kind(text: &str) -> Result<StructureKind, String> {
    named(text, StructureKind::from_name(text), StructureKind::ALL.iter().map(|kind| kind.name()))
}

/// The name of a method of rendering.
pub(crate) fn integrator(text: &str) -> Result<&'static Integrator, String> {
    named(text, Integrator::by_name(text), INTEGRATORS.iter().map(|integrator| integrator.name))
}

/// How much of the light is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Exposure {
    Factor(f32),
    Auto,
}

/// An exposure in stops, or what finds one.
pub(crate) fn exposure(text: &str) -> Result<Exposure, String> {
    match text.parse::<f32>() {
        _ if text == "auto" => Ok(Exposure::Auto),
        Ok(stops) if (-32.0..=32.0).contains(&stops) => Ok(Exposure::Factor(stops.exp2())),
        _ => {
            Err("expected stops from -32 to 32, each of which doubles the light, or auto"
                .to_owned())
        }
    }
}

/// The name of a way of tone mapping.
pub(crate) fn tone_map(text: &str) -> Result<&'static ToneMap, String> {
    named(text, ToneMap::by_name(text), TONE_MAPS.iter().map(|tone_map| tone_map.name))
}

/// Layers beside a picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Aovs(pub(crate) Vec<Aov>);

/// Names of layers between commas, or all of them.
pub(crate) fn aovs(text: &str) -> Result<Aovs, String> {
    if text == "all" {
        return Ok(Aovs(Aov::ALL.to_vec()));
    }
    let mut found = Vec::new();
    for name in text.split(',') {
        let Some(aov) = Aov::from_name(name.trim()) else {
            let names = Aov::ALL.map(Aov::name).join(", ");
            return Err(format!("`{name}` is no layer: expected some of {names}, or all"));
        };
        if !found.contains(&aov) {
            found.push(aov);
        }
    }
    Ok(Aovs(found))
}

/// The name of a filter of pixels.
pub(crate) fn pixel_filter(text: &str) -> Result<PixelFilter, String> {
    named(text, PixelFilter::from_name(text), PixelFilter::ALL.map(PixelFilter::name))
}

/// A relative error, as a share or in percent.
pub(crate) fn noise(text: &str) -> Result<f32, String> {
    let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 0.01));
    match number.trim().parse::<f32>().map(|number| unit * number) {
        Ok(noise) if noise > 0.0 && noise < 1.0 => Ok(noise),
        _ => Err("expected a relative error above 0 and below 1, as in 0.02 or 2%".to_owned()),
    }
}

/// A time, in seconds or with a unit.
pub(crate) fn duration(text: &str) -> Result<Duration, String> {
    let units = [("s", 1.0), ("m", 60.0), ("h", 3600.0)];
    let (number, unit) = units
        .into_iter()
        .find_map(|(unit, seconds)| Some((text.strip_suffix(unit)?, seconds)))
        .unwrap_or((text, 1.0));
    let seconds = number.trim().parse::<f64>().ok().filter(|number| *number > 0.0);
    seconds
        .and_then(|seconds| Duration::try_from_secs_f64(unit * seconds).ok())
        .ok_or_else(|| "expected a time, as in 30s, 5m or 1.5h".to_owned())
}

/// What is in focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Focus {
    /// What is so far from the eye.
    Distance(f32),
    /// What is seen at a pixel.
    Pixel([f32; 2]),
}

/// When a shutter opens and closes, `OPEN,CLOSE`.
pub(crate) fn shutter(text: &str) -> Result<Shutter, String> {
    match numbers(text).as_deref() {
        Ok(&[open, close]) if 0.0 <= open && open <= close && close <= 1.0 => {
            Ok(Shutter { open, close })
        }
        _ => Err("expected two numbers from 0 to 1, the second not below the first, as in 0,0.5"
            .to_owned()),
    }
}

/// A distance, or a pixel `X,Y`.
pub(crate) fn focus(text: &str) -> Result<Focus, String> {
    match numbers(text)?[..] {
        [distance] if distance > 0.0 => Ok(Focus::Distance(distance)),
        [x, y] if x >= 0.0 && y >= 0.0 => Ok(Focus::Pixel([x, y])),
        _ => Err("expected a distance above 0, or a pixel, as in 2.5 or 640,400".to_owned()),
    }
}

/// The name of a preset of builds.
pub(crate) fn build_preset(text: &str) -> Result<BuildPreset, String> {
    named(text, BuildPreset::from_name(text), BuildPreset::ALL.iter().map(|preset| preset.name()))
}

/// A number of bytes, perhaps with K, M, G or T for powers of 1024: `500M`.
pub(crate) fn memory_size(text: &str) -> Result<usize, String> {
    let units = ["K", "M", "G", "T"];
    let upper = text.to_ascii_uppercase();
    let (number, unit) = (1..)
        .zip(units)
        .find_map(|(power, unit)| Some((upper.strip_suffix(unit)?, 1024f64.powi(power))))
        .unwrap_or((&upper, 1.0));
    let is_number = number.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    match number.parse::<f64>() {
        Ok(number) if is_number => Ok((number * unit) as usize),
        _ => {
            Err("expected a number of bytes, or one with K, M, G or T, as in 500M or 1.5G"
                .to_owned())
        }
    }
}

/// The name of a level of vector instructions.
pub(crate) fn simd_level(text: &str) -> Result<SimdLevel, String> {
    named(text, SimdLevel::from_name(text), SimdLevel::ALL.iter().map(|level| level.name()))
}

/// The name of what a heat map shows.
pub(crate) fn heat_quantity(text: &str) -> Result<HeatQuantity, String> {
    named(
        text,
        HeatQuantity::from_name(text),
        HeatQuantity::ALL.iter().map(|quantity| quantity.name()),
    )
}

/// A finite number above zero.
pub(crate) fn above_zero(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("expected a number above 0".to_owned()),
    }
}

/// An angle in degrees.
pub(crate) fn degrees(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(degrees) if degrees.abs() <= 1e6 => Ok(degrees),
        _ => Err("expected degrees, as in 360 or -90".to_owned()),
    }
}

/// A vertical field of view in degrees, between 0 and 180.
pub(crate) fn field_of_view(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(degrees) if degrees > 0.0 && degrees < 180.0 => Ok(degrees),
        _ => Err("expected degrees above 0 and below 180".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_sizes_and_lights() {
        assert_eq!("1,-2.5, 3e2".parse(), Ok(Point(Vec3::new(1.0, -2.5, 300.0))));
        for bad in ["", "1,2", "1,2,3,4", "1,2,x", "1,2,nan", "1,2,inf", "1 2 3"] {
            assert!(bad.parse::<Point>().is_err(), "{bad}");
        }
        assert_eq!("640x400".parse(), Ok(Size { width: 640, height: 400 }));
        for bad in ["640", "x", "640x", "-1x2", "1.5x2", "640x400x3", "99999999999x1"] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
        let corner = Region { x: 640, y: 0, width: 320, height: 200 };
        assert_eq!(region("640,0, 320,200"), Ok(corner));
        for bad in ["", "1,2,3", "1,2,3,4,5", "-1,0,2,2", "0,0,0,1", "0,0,1.5,1"] {
            assert!(region(bad).is_err(), "{bad}");
        }
        assert_eq!("3/8".parse(), Ok(Share { number: 3, count: 8 }));
        for bad in ["", "3", "0/8", "9/8", "1/0", "-1/2", "a/b", "1/2/3"] {
            assert!(bad.parse::<Share>().is_err(), "{bad}");
        }
        assert_eq!(
            "1,2,3,0.5".parse(),
            Ok(PointLight { position: Vec3::new(1.0, 2.0, 3.0), strength: 0.5 })
        );
        assert!("1,2,3,-1".parse::<PointLight>().is_err());
        assert_eq!((whole_number("1", 1, 9), whole_number("9", 1, 9)), (Ok(1), Ok(9)));
        for bad in ["0", "10", "1e6", "-1", "", "99999999999999999999"] {
            assert_eq!(whole_number(bad, 1, 9), Err("expected a whole number from 1 to 9".into()));
        }
        assert_eq!((degrees("-90"), degrees("720")), (Ok(-90.0), Ok(720.0)));
        assert!(["", "nan", "inf", "1e9", "round"].iter().all(|bad| degrees(bad).is_err()));
        assert_eq!(field_of_view("35"), Ok(35.0));
        assert!(["0", "180", "nan", "-5", "wide"].iter().all(|bad| field_of_view(bad).is_err()));
        assert_eq!(above_zero("0.5"), Ok(0.5));
        assert!(["0", "-1", "nan", "inf", "1e99", ""].iter().all(|bad| above_zero(bad).is_err()));
        for &preset in BuildPreset::ALL {
            assert_eq!(build_preset(preset.name()), Ok(preset));
        }
        let said = build_preset("ultra").expect_err("no such preset");
        assert_eq!(said, "expected one of fastest, fast, balanced, high, best");
        assert_eq!(memory_size("0"), Ok(0));
        assert_eq!(memory_size("123456"), Ok(123_456));
        assert_eq!(memory_size("500M"), Ok(500 << 20));
        assert_eq!((memory_size("2k"), memory_size("1.5G")), (Ok(2048), Ok(3 << 29)));
        for bad in ["", "M", "-1", "1e9", "inf", "nan", "2GB", "1 G", "0x10"] {
            let said = memory_size(bad).expect_err("no size");
            assert!(said.starts_with("expected a number of bytes"), "{bad}: {said}");
        }
        for (text, factor) in [("-1", 0.5), ("0", 1.0), ("2.0", 4.0)] {
            assert_eq!(exposure(text), Ok(Exposure::Factor(factor)));
        }
        assert_eq!(exposure("auto"), Ok(Exposure::Auto));
        assert!(["", "bright", "nan", "inf", "99"].iter().all(|bad| exposure(bad).is_err()));
        assert_eq!((noise("0.25"), noise("25%")), (Ok(0.25), Ok(0.25)));
        assert!(["", "0", "1", "-1%", "100%", "nan", "low"].iter().all(|bad| noise(bad).is_err()));
        for (text, seconds) in [("30", 30.0), ("0.5s", 0.5), ("2m", 120.0), ("1.5h", 5400.0)] {
            assert_eq!(duration(text), Ok(Duration::from_secs_f64(seconds)));
        }
        for bad in ["", "s", "0", "-1s", "nan", "inf", "1e300h", "1d", "soon"] {
            assert!(duration(bad).is_err(), "{bad}");
        }
        assert_eq!(focus("2.5"), Ok(Focus::Distance(2.5)));
        assert_eq!(focus("640,0"), Ok(Focus::Pixel([640.0, 0.0])));
        assert!(["", "0", "-1", "1,-1", "1,2,3", "near"].iter().all(|bad| focus(bad).is_err()));
        assert_eq!(pixel_filter("box"), Ok(PixelFilter::Box));
        assert!(
            pixel_filter("gauss").is_err_and(|said| said.ends_with("tent, box, blackman-harris"))
        );
        assert_eq!(aovs("ids, depth,ids"), Ok(Aovs(vec![Aov::Ids, Aov::Depth])));
        assert_eq!(aovs("all"), Ok(Aovs(Aov::ALL.to_vec())));
        assert!(aovs("depth,").is_err_and(|said| said.starts_with("`` is no layer: expected")));
        assert_eq!(tone_map("agx").map(|map| map.name), Ok("agx"));
        let said = tone_map("filmic").expect_err("no such tone map");
        assert_eq!(said, "expected one of soft, none, reinhard, aces, agx, neutral");
        assert_eq!(integrator("depth").map(|i| i.name), Ok("depth"));
        for (wrong, right) in [("normal", "normals"), ("witted", "whitted"), ("Depth", "depth")] {
            let said = integrator(wrong).expect_err("no such integrator");
            assert!(said.starts_with(&format!("did you mean {right}? ")), "{said}");
        }
        let said = integrator("photon-mapping").expect_err("no such integrator");
        assert!(said.starts_with("expected one of whitted, "), "{said}");
        assert_eq!(heat_quantity("tests"), Ok(HeatQuantity::Tests));
        let said = heat_quantity("time").expect_err("no such quantity");
        assert_eq!(said, "expected one of nodes, boxes, primitives, tests");
    }
}
