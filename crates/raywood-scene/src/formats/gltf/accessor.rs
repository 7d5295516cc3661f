//! Reads accessors: typed, strided, possibly sparse arrays in buffers. Every range is checked before it is read.

use gltf_json::accessor::ComponentType;
use gltf_json::validation::Checked;

use super::document::Document;
use crate::error::LoadError;

/// An accessor whose ranges have been checked.
pub(super) struct Reader<'a> {
    /// The bytes from the first element on; none if all elements are zero but for the sparse ones.
    base: Option<Strided<'a>>,
    sparse: Option<Sparse<'a>>,
    /// How many elements it has.
    pub(super) count: usize,
    component: ComponentType,
    /// How many numbers an element has.
    pub(super) components: usize,
    normalized: bool,
}

/// Elements at equal distances.
#[derive(Clone, Copy)]
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

/// Elements that differ from the base.
struct Sparse<'a> {
    indices: Vec<u32>,
    values: Strided<'a>,
}

impl<'a> Strided<'a> {
    /// The bytes of an element.
    #[inline]
    fn get(&self, index: usize) -> &'a [u8] {
        let start = index * self.stride;
        self.bytes.get(start..start + self.size).unwrap_or(&[])
    }
}

/// The number of bytes of one number.
fn size_of(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

/// Opens an accessor of the document.
pub(super) fn open<'a>(document: &'a Document<'_>, index: usize) -> Result<Reader<'a>, LoadError> {
    let place = || format!("accessors[{index}]");
    let invalid = || document.error(place(), "has a type that glTF does not know");
    let accessor = document.root.accessors.get(index).ok_or_else(invalid)?;
    let (Checked::Valid(component), Checked::Valid(kind)) =
        (accessor.component_type, accessor.type_)
    else {
        return Err(invalid());
    };
    let component = component.0;
    let components = kind.multiplicity();
    let size = size_of(component) * components;
    let count = accessor.count.0;

    let base = match accessor.buffer_view {
        Some(view) => {
            let offset = accessor.byte_offset.unwrap_or_default().0;
            Some(strided(document, place, view.value(), offset, size, count)?)
        }
        None => {
            // Nothing but sparse elements bounds such an array; a mesh of zeros is of no use.
            let most = document.buffers.iter().map(|buffer| buffer.len() as u64).sum::<u64>();
            if count > most.max(1 << 16) {
                let message = format!("has {count} elements but no bufferView to hold them");
                return Err(document.error(place(), message));
            }
            None
        }
    };
    let sparse = match &accessor.sparse {
        None => None,
        Some(sparse) => {
            let (indices, values) = (&sparse.indices, &sparse.values);
            let Checked::Valid(index_type) = indices.component_type else { return Err(invalid()) };
            let index_size = size_of(index_type.0);
            let number = sparse.count.0;
            let place = || format!("accessors[{index}].sparse");
            let offset = indices.byte_offset.0;
            let view = indices.buffer_view.value();
            let bytes = strided(document, place, view, offset, index_size, number)?;
            let view = values.buffer_view.value();
            let values = strided(document, place, view, values.byte_offset.0, size, number)?;
            let indices: Vec<u32> =
                (0..number as usize).map(|i| integer(index_type.0, bytes.get(i))).collect();
            if let Some(&outside) = indices.iter().find(|&&i| u64::from(i) >= count) {
                let message = format!("names element {outside}, but the accessor has {count}");
                return Err(document.error(place(), message));
            }
            Some(Sparse { indices, values })
        }
    };
    let normalized = accessor.normalized;
    Ok(Reader { base, sparse, count: count as usize, component, components, normalized })
}

/// Elements in a buffer view, all of them within it.
fn strided<'a>(
    document: &'a Document<'_>,
    place: impl Fn() -> String,
    view: usize,
    offset: u64,
    size: usize,
    count: u64,
) -> Result<Strided<'a>, LoadError> {
    let absent = || document.error(place(), "names a bufferView or buffer that is not there");
    let buffer_view = document.root.buffer_views.get(view).ok_or_else(absent)?;
    let buffer = document.buffers.get(buffer_view.buffer.value()).ok_or_else(absent)?;

    // The view within its buffer.
    let start = buffer_view.byte_offset.unwrap_or_default().0;
    let length = buffer_view.byte_length.0;
    let end = start.checked_add(length).filter(|&end| end <= buffer.len() as u64);
    let Some(end) = end else {
        let message = format!(
            "covers {length} bytes from byte {start} of buffer {}, which has {}",
            buffer_view.buffer.value(),
            buffer.len()
        );
        return Err(document.error(format!("bufferViews[{view}]"), message));
    };
    let bytes = &buffer[start as usize..end as usize];

    // The elements within the view.
    let stride = buffer_view.byte_stride.map_or(size, |stride| stride.0).max(1);
    let last = count.checked_sub(1).map(|last| last.checked_mul(stride as u64));
    let needed = match last {
        None => Some(0),
        Some(last) => last
            .and_then(|last| last.checked_add(size as u64))
            .and_then(|needed| needed.checked_add(offset)),
    };
    match needed.filter(|&needed| needed <= length) {
        Some(_) => {
            let bytes = bytes.get(offset as usize..).unwrap_or(&[]);
            Ok(Strided { bytes, stride, size })
        }
        None => {
            let message = format!(
                "its {count} elements of {size} bytes reach past the end of bufferViews[{view}], which has {length} bytes"
            );
            Err(document.error(place(), message))
        }
    }
}

/// An integer out of its bytes; zero for other types.
#[inline]
fn integer(component: ComponentType, bytes: &[u8]) -> u32 {
    match (component, bytes) {
        (ComponentType::U8, &[a, ..]) => u32::from(a),
        (ComponentType::U16, &[a, b, ..]) => u32::from(u16::from_le_bytes([a, b])),
        (ComponentType::U32, &[a, b, c, d, ..]) => u32::from_le_bytes([a, b, c, d]),
        _ => 0,
    }
}

/// A number out of its bytes; normalised, integers become 0 to 1 or -1 to 1.
#[inline]
fn float(component: ComponentType, normalized: bool, bytes: &[u8]) -> f32 {
    let (value, largest) = match (component, bytes) {
        (ComponentType::F32, &[a, b, c, d, ..]) => return f32::from_le_bytes([a, b, c, d]),
        (ComponentType::I8, &[a, ..]) => (f32::from(a as i8), 127.0),
        (ComponentType::U8, &[a, ..]) => (f32::from(a), 255.0),
        (ComponentType::I16, &[a, b, ..]) => (f32::from(i16::from_le_bytes([a, b])), 32767.0),
        (ComponentType::U16, &[a, b, ..]) => (f32::from(u16::from_le_bytes([a, b])), 65535.0),
        (ComponentType::U32, &[a, b, c, d, ..]) => {
            (u32::from_le_bytes([a, b, c, d]) as f32, 4_294_967_295.0)
        }
        _ => (0.0, 1.0),
    };
    if normalized { (value / largest).max(-1.0) } else { value }
}

impl Reader<'_> {
    /// Gives every element as `N` numbers (those that an element lacks are zero) to `each`, in order.
    pub(super) fn read<const N: usize>(&self, mut each: impl FnMut([f32; N])) {
        let size = size_of(self.component);
        let numbers = N.min(self.components);
        let element = |bytes: &[u8]| {
            let mut element = [0.0; N];
            for (number, bytes) in element[..numbers].iter_mut().zip(bytes.chunks_exact(size)) {
                *number = float(self.component, self.normalized, bytes);
            }
            element
        };
        match (self.base, &self.sparse) {
            (Some(base), None) => (0..self.count).for_each(|i| each(element(base.get(i)))),
            (base, sparse) => {
                let base_of = |i| base.map_or([0.0; N], |base| element(base.get(i)));
                let mut elements: Vec<[f32; N]> = (0..self.count).map(base_of).collect();
                if let Some(sparse) = sparse {
                    for (k, &i) in sparse.indices.iter().enumerate() {
                        elements[i as usize] = element(sparse.values.get(k));
                    }
                }
                elements.into_iter().for_each(each);
            }
        }
    }

    /// All elements as indices; none if they are no unsigned integers.
    pub(super) fn indices(&self) -> Option<Vec<u32>> {
        let unsigned =
            matches!(self.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        if self.components != 1 || !unsigned {
            return None;
        }
        let read = |bytes: &[u8]| integer(self.component, bytes);
        let mut indices: Vec<u32> =
            (0..self.count).map(|i| self.base.map_or(0, |base| read(base.get(i)))).collect();
        if let Some(sparse) = &self.sparse {
            for (k, &i) in sparse.indices.iter().enumerate() {
                indices[i as usize] = read(sparse.values.get(k));
            }
        }
        Some(indices)
    }
}
