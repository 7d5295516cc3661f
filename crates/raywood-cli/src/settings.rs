//! What a picture is of and how it is rendered, in names and values: what films in files say, by which pictures are told apart.

use raywood::{SimdLevel, StructureKind};
use raywood_render::{Goal, PreparedScene, RenderOptions, Shutter, View};
use raywood_scene::{Light, Scene};

/// Names of settings and their values.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Settings(Vec<(String, String)>);

/// What the scene is called: says nothing of the picture, as files may lie elsewhere on another machine.
const NAME: &str = "scene";

/// Settings on which only last digits of a picture depend.
const OF_DIGITS: [&str; 3] = ["version", "--structure and --build", "--simd"];

/// With what names begin whose values are checksums.
const OF_SCENE: &str = "the scene's ";

/// What settings have to do with pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Weight {
    /// Another value, another picture.
    Picture,
    /// Another value, other last digits.
    Digits,
}

impl Settings {
    /// Those of a picture whatever it is of: all that its file says. `in_passes` is whether samples come a few at a time.
    pub(crate) fn of_picture(options: &RenderOptions, goal: &Goal, in_passes: bool) -> Self {
        // All fields, so that a new one is not forgotten.
        let RenderOptions {
            width,
            height,
            samples,
            filter,
            seed,
            lens,
            shutter,
            max_depth,
            cutoff,
            opaque_shadows,
            integrator,
        } = options;
        let mut settings = Self::default();
        settings.say("--size", format!("{width}x{height}"));
        settings.say("--integrator", integrator.name);
        // Where noise or time decide, the number is but a limit, which may change.
        settings.say(
            "--samples",
            match goal.is_open() {
                true => "left to --noise or --time".to_owned(),
                false => samples.to_string(),
            },
        );
        settings.say("passes", if in_passes { "of a few samples" } else { "of all samples" });
        settings.say("--seed", seed.to_string());
        settings.say("--filter", filter.name());
        settings.say("--depth", max_depth.to_string());
        settings.say("cut-off", cutoff.to_string());
        settings.say("--opaque-shadows", if *opaque_shadows { "on" } else { "off" });
        if let Some(lens) = lens {
            settings.say("lens", format!("radius {}, focus {}", lens.radius, lens.focus));
        }
        // Left out as long as it is not asked for, so that films from before there was one can go on.
        if *shutter != Shutter::default() {
            settings.say("--shutter", format!("{},{}", shutter.open, shutter.close));
        }
        settings
    }

    /// Adds those of what it is of, and `build`, how the structure of that kind was come by. O(size of the scene).
    pub(crate) fn add_scene(
        &mut self,
        prepared: &PreparedScene<'_>,
        view: &View,
        kind: StructureKind,
        build: &str,
    ) {
        let scene: &Scene = prepared.scene();
        let View { camera, lights } = view;
        self.say(NAME, scene.name.as_str());
        let [eye, target, up] = [camera.eye, camera.target, camera.up]
            .map(|vector| vector.to_array().map(|number| number.to_string()).join(","));
        self.say("camera", format!("at {eye} to {target}, up {up}, fov {}", camera.fov_y));
        let mut checksum = |name: &str, sum: u32| {
            self.say(&format!("{OF_SCENE}{name}"), format!("{sum:08x}"));
        };
        checksum("lights", Light::checksum(lights));
        for (name, sum) in scene.checksums() {
            checksum(name, sum);
        }
        if let Some(environment) = prepared.other_environment() {
            self.say("--environment", format!("{:08x}", environment.checksum()));
        }
        self.say("version", env!("CARGO_PKG_VERSION"));
        let stats = prepared.stats();
        let (kind, nodes, bytes) = (kind.name(), stats.nodes, stats.bytes);
        let structure = format!("{kind} ({build}) of {nodes} nodes and {bytes} bytes");
        self.say("--structure and --build", structure);
        self.say("--simd", SimdLevel::active().name());
    }

    /// Those that a file has.
    pub(crate) fn of_file(settings: Vec<(String, String)>) -> Self {
        Self(settings)
    }

    /// As a file has them.
    pub(crate) fn into_pairs(self) -> Vec<(String, String)> {
        self.0
    }

    fn say(&mut self, name: &str, value: impl Into<String>) {
        self.0.push((name.to_owned(), value.into()));
    }

    /// The value of a setting.
    pub(crate) fn value(&self, name: &str) -> Option<&str> {
        let setting = self.0.iter().find(|(other, _)| other == name);
        setting.map(|(_, value)| value.as_str())
    }

    /// The same with another value, which takes the place of one that is there.
    #[must_use]
    pub(crate) fn with(mut self, name: &str, value: &str) -> Self {
        if let Some((_, old)) = self.0.iter_mut().find(|(other, _)| other == name) {
            *old = value.to_owned();
        }
        self
    }

    /// In what these differ from others, in words: `its` are those of a file, `others` of what `place` names.
    pub(crate) fn differences(&self, others: &Self, place: &str, weight: Weight) -> Vec<String> {
        let mut names: Vec<_> = self.0.iter().chain(&others.0).map(|(name, _)| name).collect();
        let mut seen = Vec::new();
        names.retain(|name| {
            let is_new = !seen.contains(name);
            seen.push(*name);
            let of_digits = OF_DIGITS.contains(&name.as_str());
            is_new && *name != NAME && of_digits == (weight == Weight::Digits)
        });
        let differing =
            names.into_iter().filter(|name| self.value(name) != others.value(name)).map(|name| {
                if name.starts_with(OF_SCENE) {
                    return format!("{name} are others");
                }
                let [own, other] =
                    [self, others].map(|settings| settings.value(name).unwrap_or("not given"));
                format!("{name} is {own} in it, {other} {place}")
            });
        differing.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_named_with_both_values() {
        let with = |depth: u32, simd: &str| {
            let options = RenderOptions { max_depth: depth, ..RenderOptions::default() };
            let mut settings = Settings::of_picture(&options, &Goal::default(), false);
            settings.say("--simd", simd);
            settings.say("the scene's triangles", format!("{depth:08x}"));
            settings
        };
        let (one, same, other) = (with(10, "avx2"), with(10, "avx512"), with(5, "avx2"));
        assert_eq!(one.differences(&same, "now", Weight::Picture), [""; 0]);
        assert_eq!(
            one.differences(&same, "now", Weight::Digits),
            ["--simd is avx2 in it, avx512 now"]
        );
        assert_eq!(
            one.differences(&other, "in a.film", Weight::Picture),
            ["--depth is 10 in it, 5 in a.film", "the scene's triangles are others"]
        );
        let mut lens = one.clone();
        lens.say("lens", "radius 1, focus 2");
        assert_eq!(
            one.differences(&lens, "now", Weight::Picture),
            ["lens is not given in it, radius 1, focus 2 now"]
        );
        let shutter = Shutter { open: 0.25, close: 0.5 };
        let options = RenderOptions { max_depth: 10, shutter, ..RenderOptions::default() };
        let quick = Settings::of_picture(&options, &Goal::default(), false);
        let usual = Settings::of_picture(&RenderOptions::default(), &Goal::default(), false);
        assert_eq!(
            quick.differences(&usual, "in b.film", Weight::Picture),
            ["--shutter is 0.25,0.5 in it, not given in b.film"]
        );
        assert_eq!(one.clone().with("--depth", "5").value("--depth"), Some("5"));
    }
}
