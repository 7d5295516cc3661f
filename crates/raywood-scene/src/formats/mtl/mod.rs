//! Wavefront MTL: the materials of OBJ files.
//!
//! How its numbers become a [`Material`]:
//!
//! | MTL | here |
//! | --- | --- |
//! | `Kd` | diffuse, taken as linear light, at most 1; times the opacity |
//! | `Ks`, `Ns` | highlight, unless `illum` is 0 or 1 or `Ns` is below 1 |
//! | `Ks` with `illum` 3, 5, 8 | mirror |
//! | `d`, or 1 - `Tr` | opacity; what is not opaque is let through, tinted by `Tf` |
//! | `illum` 4, 6, 7, 9 with `Ni` above 1 | refraction with that index; glass all through if `d` is 1 |
//! | `Ke` | emission |
//! | `map_Kd`, `map_Ks`, `map_Ke` | textures that multiply these colours; a `Kd` or `Ke` of zero counts as one |
//! | `map_d`, `map_Tr` | opacity: alpha, or how bright the image is if it has none |
//! | `norm`, `map_Kn` | normals |
//! | `map_Bump`, `bump`, with `-bm` | heights if the image is gray, else normals |
//! | `-s`, `-o`, `-clamp` | size, place and edges of a texture |
//! | `map_Ns`, `map_Pr`, `disp`, `refl` and others | not shown, said in a warning |

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use self::map::{ImageFile, Map};
use super::Input;
use super::file_name;
use super::images::{ImageRequests, Use};
use super::notes::{Notes, counted};
use super::text::Cursor;
use crate::error::{LoadError, Place, quoted};
use crate::load::read_file;
use crate::{Material, Rgb, SurfaceTextures};

mod map;

/// Materials by the bytes of their names.
pub(crate) type Library = HashMap<Vec<u8>, Definition>;

/// The images of the materials in use.
pub(crate) type Images = ImageRequests<ImageFile>;

/// Reads the files that the operand of an `mtllib` names, beside the OBJ file: one file whose name has spaces, or several with
/// spaces between (`\ ` stands for one within a name). A file that is not there is a fault that can be mended.
pub(crate) fn load_named(
    input: &Input<'_>,
    operand: &[u8],
    place: impl Fn() -> Place,
    notes: &mut Notes,
    library: &mut Library,
) -> Result<(), LoadError> {
    let folder = input.path.parent().unwrap_or(Path::new(""));
    let is_there = |name: &Vec<u8>| file_name::find(folder, name).is_some();
    let mut names = vec![operand.to_vec()];
    if !is_there(&names[0]) {
        let several = split_names(operand);
        if several.iter().any(is_there) {
            names = several;
        }
    }
    for name in names {
        match file_name::find(folder, &name) {
            Some(path) => load(&path, input.options.strict, notes, library)?,
            None => {
                let problem = format!("material file {} is not there", quoted(&name));
                notes.mend_line(place(), &problem, "its materials are missing")?;
            }
        }
    }
    Ok(())
}

/// Names with blanks between them.
fn split_names(operand: &[u8]) -> Vec<Vec<u8>> {
    let mut names = vec![Vec::new()];
    let mut bytes = operand.iter().copied().peekable();
    while let Some(byte) = bytes.next() {
        match byte {
            b'\\' if bytes.peek() == Some(&b' ') => {
                names.last_mut().unwrap_or(&mut Vec::new()).push(b' ');
                bytes.next();
            }
            b' ' | b'\t' => names.push(Vec::new()),
            _ => names.last_mut().unwrap_or(&mut Vec::new()).push(byte),
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

/// Adds the materials of a file. Of two with the same name the first counts.
fn load(
    path: &Path,
    strict: bool,
    notes: &mut Notes,
    library: &mut Library,
) -> Result<(), LoadError> {
    let bytes = read_file(path)?;
    let mut parser = Parser {
        cursor: Cursor::new(path, &bytes),
        notes: Notes::new(path, strict),
        textures: BTreeSet::new(),
    };
    for (name, mut definition) in parser.parse()? {
        definition.folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let material = definition.plain_material();
        if material.transmission == Rgb::ONE && material.ior == 1.0 {
            let name = quoted(&name);
            parser.notes.say(format!("material {name} is wholly transparent: it will not be seen"));
        }
        library.entry(name).or_insert(definition);
    }
    let Parser { notes: mut own, textures, .. } = parser;
    if !textures.is_empty() {
        let kinds: BTreeSet<&str> = textures.iter().map(|(_, kind)| *kind).collect();
        let kinds = kinds.into_iter().collect::<Vec<_>>().join(", ");
        let files = textures.iter().map(|(file, _)| file).collect::<BTreeSet<_>>().len();
        let verb = if files == 1 { "is" } else { "are" };
        own.say(format!("{} {verb} not shown: {kinds}", counted(files, "texture")));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    notes.append(own, &name);
    Ok(())
}

/// A material as the file gives it.
#[derive(Debug, Default)]
pub(crate) struct Definition {
    diffuse: Option<Rgb>,
    specular: Option<Rgb>,
    emission: Option<Rgb>,
    shininess: Option<f32>,
    ior: Option<f32>,
    dissolve: Option<f32>,
    transparency: Option<f32>,
    filter: Option<Rgb>,
    illumination: Option<i64>,
    /// Its maps of colours, opacity and normals, and whether these may be heights.
    diffuse_map: Option<Map>,
    specular_map: Option<Map>,
    emission_map: Option<Map>,
    opacity_map: Option<Map>,
    normal_map: Option<Map>,
    may_be_heights: bool,
    /// Where the file is, beside which images are sought.
    folder: PathBuf,
}

/// A file on the way.
struct Parser<'a> {
    cursor: Cursor<'a>,
    notes: Notes,
    /// The texture files named, and what each is for.
    textures: BTreeSet<(Vec<u8>, &'static str)>,
}

impl Parser<'_> {
    /// Reads all materials. What stands before the first name is nothing's, and passed over.
    fn parse(&mut self) -> Result<Vec<(Vec<u8>, Definition)>, LoadError> {
        let mut materials: Vec<(Vec<u8>, Definition)> = Vec::new();
        let mut nothing = Definition::default();
        while !self.cursor.at_end() {
            let word = self.cursor.word();
            let material = materials.last_mut().map_or(&mut nothing, |(_, material)| material);
            match word {
                b"newmtl" => {
                    let name = self.cursor.rest_of_line().to_vec();
                    materials.push((name, Definition::default()));
                }
                b"Kd" => self.color(&mut material.diffuse)?,
                b"Ks" => self.color(&mut material.specular)?,
                b"Ke" => self.color(&mut material.emission)?,
                b"Tf" | b"Kt" => self.color(&mut material.filter)?,
                b"Ns" => self.scalar(&mut material.shininess)?,
                b"Ni" => self.scalar(&mut material.ior)?,
                b"Tr" => self.scalar(&mut material.transparency)?,
                b"d" => self.scalar(&mut material.dissolve)?,
                b"illum" => {
                    self.cursor.skip_blanks();
                    material.illumination = self.cursor.integer();
                }
                _ => Self::map(&mut self.cursor, &mut self.textures, material, word),
            }
            self.cursor.next_line();
        }
        Ok(materials)
    }

    /// A colour: three numbers, or one for all channels.
    fn color(&mut self, color: &mut Option<Rgb>) -> Result<(), LoadError> {
        let mut numbers = [0.0; 3];
        for i in 0..3 {
            self.cursor.skip_blanks();
            match self.cursor.number().filter(|value| value.is_finite()) {
                Some(value) => numbers[i..].fill(value.max(0.0)),
                None if i == 1
                    && matches!(self.cursor.peek(), None | Some(b'\n' | b'\r' | b'#')) =>
                {
                    break;
                }
                None => return self.bad_value("a colour (three numbers)"),
            }
        }
        *color = Some(Rgb::from(numbers));
        Ok(())
    }

    /// A number, possibly after an option such as `-halo`.
    fn scalar(&mut self, scalar: &mut Option<f32>) -> Result<(), LoadError> {
        let start = self.cursor.offset();
        self.cursor.skip_blanks();
        let mut value = self.cursor.number();
        if value.is_none() && self.cursor.word() == b"-halo" {
            self.cursor.skip_blanks();
            value = self.cursor.number();
        }
        match value.filter(|value| value.is_finite()) {
            Some(value) => *scalar = Some(value),
            None => {
                self.cursor.set_offset(start);
                return self.bad_value("a number");
            }
        }
        Ok(())
    }

    /// A value that cannot be read; the cursor stands before it.
    fn bad_value(&mut self, expected: &str) -> Result<(), LoadError> {
        let found = match self.cursor.clone().word() {
            b"" => "the line ends".to_owned(),
            word => format!("found {}", quoted(word)),
        };
        let problem = format!("{found}, expected {expected}");
        self.notes.mend_line(self.cursor.place(), &problem, "left at its default")
    }

    /// A statement that names a texture, or one that means nothing here.
    fn map(
        cursor: &mut Cursor<'_>,
        unknown: &mut BTreeSet<(Vec<u8>, &'static str)>,
        material: &mut Definition,
        word: &[u8],
    ) {
        let kind = match &word.to_ascii_lowercase()[..] {
            b"map_kd" => return material.diffuse_map = Map::read(cursor),
            b"map_ks" => return material.specular_map = Map::read(cursor),
            b"map_ke" => return material.emission_map = Map::read(cursor),
            b"map_d" | b"map_tr" => return material.opacity_map = Map::read(cursor),
            b"norm" | b"map_kn" => {
                material.may_be_heights = false;
                return material.normal_map = Map::read(cursor);
            }
            b"map_bump" | b"bump" => {
                // Normals are better than heights.
                if material.normal_map.is_none() || material.may_be_heights {
                    material.may_be_heights = true;
                    material.normal_map = Map::read(cursor);
                }
                return;
            }
            b"map_ka" => "ambient",
            b"map_ns" => "shininess",
            b"disp" => "displacement",
            b"decal" => "decal",
            b"refl" => "reflection",
            other if other.starts_with(b"map_p") => "roughness and metal",
            _ => return,
        };
        unknown.insert((cursor.rest_of_line().to_vec(), kind));
    }
}

impl Definition {
    /// As Whitted's method can show it: see the table at the top. Its textures' images are asked for.
    pub(crate) fn material(&self, name: String, images: &mut Images) -> Material {
        let mut ask = |map: &Option<Map>, use_: Use| {
            map.as_ref().map(|map| map.texture(&self.folder, use_, images))
        };
        let normal_use = if self.may_be_heights { Use::Bumps } else { Use::Normals };
        let textures = SurfaceTextures {
            color: ask(&self.diffuse_map, Use::Color),
            specular_color: ask(&self.specular_map, Use::ColorFactors),
            emission: ask(&self.emission_map, Use::Emission),
            opacity_map: ask(&self.opacity_map, Use::Opacity),
            opacity: self.opacity_map.as_ref().map(|_| self.opacity()),
            normal: ask(&self.normal_map, normal_use)
                .map(|texture| (texture, self.normal_map.as_ref().map_or(1.0, |map| map.strength))),
            ..SurfaceTextures::default()
        };
        let mut material = Material { name, ..self.plain_material() };
        if textures != SurfaceTextures::default() {
            material.textures = Some(Box::new(textures));
        }
        material
    }

    /// How much of the surface is not let through.
    fn opacity(&self) -> f32 {
        let opacity = self.dissolve.or(self.transparency.map(|t| 1.0 - t)).unwrap_or(1.0);
        opacity.clamp(0.0, 1.0)
    }

    /// The material without its name and textures.
    fn plain_material(&self) -> Material {
        let base = Material::default();
        let illumination = self.illumination.unwrap_or(2);
        let specular = self.specular.unwrap_or(Rgb::ZERO);
        // A texture is never meant to be multiplied by nothing.
        let unless_black = |color: Option<Rgb>, other: Rgb| match color {
            Some(color) if color != Rgb::ZERO => color,
            _ => other,
        };
        let mut diffuse = match self.diffuse_map {
            Some(_) => unless_black(self.diffuse, Rgb::ONE),
            None => self.diffuse.unwrap_or(base.diffuse),
        };
        let emission = match self.emission_map {
            Some(_) => unless_black(self.emission, Rgb::ONE),
            None => self.emission.unwrap_or(Rgb::ZERO),
        };

        // Highlights. Exponents below one are how exporters say that there is none.
        let shininess = self.shininess.unwrap_or(base.shininess);
        let has_highlight = illumination >= 2 && shininess >= 1.0;

        // How much is let through, and whether it is bent. An index alone does not make glass: many programs write one for
        // everything.
        let refracts = matches!(self.illumination, Some(4 | 6 | 7 | 9) | None);
        let ior = self.ior.filter(|ior| refracts && (1.0..=10.0).contains(ior)).unwrap_or(1.0);
        let filter = self.filter.unwrap_or(Rgb::ONE).min(Rgb::ONE);
        // A map of opacity has the factor too.
        let opacity = if self.opacity_map.is_some() { 1.0 } else { self.opacity() };
        let is_glass = self.illumination.is_some() && ior > 1.0 && opacity == 1.0;
        let transmission = if is_glass { filter } else { (1.0 - opacity) * filter };
        diffuse = if is_glass { Rgb::ZERO } else { opacity * diffuse.min(Rgb::ONE) };

        Material {
            diffuse,
            specular: if has_highlight { specular.min(Rgb::ONE) } else { Rgb::ZERO },
            shininess: shininess.clamp(1.0, 1e5),
            mirror: match illumination {
                3 | 5 | 8 => specular.min(Rgb::ONE),
                _ => Rgb::ZERO,
            },
            transmission,
            ior,
            emission,
            ..base
        }
    }
}
