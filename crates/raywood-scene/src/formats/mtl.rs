//! Wavefront MTL: the materials of OBJ files.
//!
//! How its numbers become a [`Material`]:
//!
//! | MTL | here |
//! | --- | --- |
//! | `Kd` | diffuse, taken as linear light; times the opacity |
//! | `Ks`, `Ns` | highlight, unless `illum` is 0 or 1 or `Ns` is below 1 |
//! | `Ks` with `illum` 3, 5, 8 | mirror |
//! | `d`, or 1 - `Tr` | opacity; what is not opaque is let through, tinted by `Tf` |
//! | `illum` 4, 6, 7, 9 with `Ni` above 1 | refraction with that index; glass all through if `d` is 1 |
//! | `Ke` | emission |
//! | `map_...`, `bump`, `disp`, `refl`, `norm` | textures: not shown yet, said in a warning |

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use super::Input;
use super::notes::{Notes, counted};
use super::text::Cursor;
use crate::error::{LoadError, Place, quoted};
use crate::load::read_file;
use crate::{Material, Rgb};

/// Materials by the bytes of their names.
pub(crate) type Library = HashMap<Vec<u8>, Material>;

/// Reads the files that the operand of an `mtllib` names, beside the OBJ file: one file whose name has spaces, or several with
/// spaces between (`\ ` stands for one within a name). A file that is not there is a fault that can be mended.
pub(crate) fn load_named(
    input: &Input<'_>,
    operand: &[u8],
    place: impl Fn() -> Place,
    notes: &mut Notes,
    library: &mut Library,
) -> Result<(), LoadError> {
    let is_there = |name: &Vec<u8>| find(input.path, name).is_some();
    let mut names = vec![operand.to_vec()];
    if !is_there(&names[0]) {
        let several = split_names(operand);
        if several.iter().any(is_there) {
            names = several;
        }
    }
    for name in names {
        match find(input.path, &name) {
            Some(path) => load(&path, input.options.strict, notes, library)?,
            None => {
                let problem = format!("material file {} is not there", quoted(&name));
                notes.mend_line(place(), &problem, "its materials are missing")?;
            }
        }
    }
    Ok(())
}

/// Where a file named in an OBJ file is: as named, else with the strokes of Windows turned, else right beside it.
fn find(obj: &Path, name: &[u8]) -> Option<PathBuf> {
    let name = std::str::from_utf8(name).ok().filter(|name| !name.is_empty())?;
    let folder = obj.parent().unwrap_or(Path::new(""));
    let turned = name.replace('\\', "/");
    let bare = turned.rsplit('/').next().unwrap_or_default().to_owned();
    [name.to_owned(), turned, bare].iter().map(|n| folder.join(n)).find(|path| path.is_file())
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
    for (name, definition) in parser.parse()? {
        let material = definition.material(String::from_utf8_lossy(&name).into_owned());
        if material.transmission == Rgb::ONE && material.ior == 1.0 {
            let name = quoted(&name);
            parser.notes.say(format!("material {name} is wholly transparent: it will not be seen"));
        }
        library.entry(name).or_insert(material);
    }
    let Parser { notes: mut own, textures, .. } = parser;
    if !textures.is_empty() {
        let kinds: BTreeSet<&str> = textures.iter().map(|(_, kind)| *kind).collect();
        let kinds = kinds.into_iter().collect::<Vec<_>>().join(", ");
        let files = textures.iter().map(|(file, _)| file).collect::<BTreeSet<_>>().len();
        let verb = if files == 1 { "is" } else { "are" };
        own.say(format!("{} {verb} not shown yet: {kinds}", counted(files, "texture")));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    notes.append(own, &name);
    Ok(())
}

/// A material as the file gives it.
#[derive(Debug, Default)]
struct Definition {
    diffuse: Option<Rgb>,
    specular: Option<Rgb>,
    emission: Option<Rgb>,
    shininess: Option<f32>,
    ior: Option<f32>,
    dissolve: Option<f32>,
    transparency: Option<f32>,
    filter: Option<Rgb>,
    illumination: Option<i64>,
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
                _ => self.texture(word),
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
    fn texture(&mut self, word: &[u8]) {
        let kind = match &word.to_ascii_lowercase()[..] {
            b"map_kd" => "diffuse",
            b"map_ka" => "ambient",
            b"map_ks" => "specular",
            b"map_ns" => "shininess",
            b"map_ke" => "emission",
            b"map_d" | b"map_tr" => "opacity",
            b"map_bump" | b"bump" => "bump",
            b"norm" | b"map_kn" => "normal",
            b"disp" => "displacement",
            b"decal" => "decal",
            b"refl" => "reflection",
            other if other.starts_with(b"map_p") => "roughness and metal",
            _ => return,
        };
        self.textures.insert((self.cursor.rest_of_line().to_vec(), kind));
    }
}

impl Definition {
    /// As Whitted's method can show it: see the table at the top.
    fn material(&self, name: String) -> Material {
        let base = Material::default();
        let illumination = self.illumination.unwrap_or(2);
        let specular = self.specular.unwrap_or(Rgb::ZERO);
        let mut diffuse = self.diffuse.unwrap_or(base.diffuse);

        // Highlights. Exponents below one are how exporters say that there is none.
        let shininess = self.shininess.unwrap_or(base.shininess);
        let has_highlight = illumination >= 2 && shininess >= 1.0;

        // How much is let through, and whether it is bent. An index alone does not make glass: many programs write one for
        // everything.
        let refracts = matches!(self.illumination, Some(4 | 6 | 7 | 9) | None);
        let ior = self.ior.filter(|ior| refracts && (1.0..=10.0).contains(ior)).unwrap_or(1.0);
        let filter = self.filter.unwrap_or(Rgb::ONE).min(Rgb::ONE);
        let opacity = self.dissolve.or(self.transparency.map(|t| 1.0 - t)).unwrap_or(1.0);
        let opacity = opacity.clamp(0.0, 1.0);
        let is_glass = self.illumination.is_some() && ior > 1.0 && opacity == 1.0;
        let transmission = if is_glass { filter } else { (1.0 - opacity) * filter };
        diffuse = if is_glass { Rgb::ZERO } else { opacity * diffuse };

        Material {
            name,
            diffuse,
            specular: if has_highlight { specular.min(Rgb::ONE) } else { Rgb::ZERO },
            shininess: shininess.clamp(1.0, 1e5),
            mirror: match illumination {
                3 | 5 | 8 => specular.min(Rgb::ONE),
                _ => Rgb::ZERO,
            },
            transmission,
            ior,
            emission: self.emission.unwrap_or(Rgb::ZERO),
            ..base
        }
    }
}
