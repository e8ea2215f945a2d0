//! Accessors: typed arrays inside buffers, with strides, normalized integers and sparse patches.

use super::buffers::{Buffers, View};
use super::document::{Accessor, Sparse};
use crate::error::{Damage, Place, check_finite};

/// Most elements of an accessor that has no bytes behind it (all zeros by definition).
const MOST_ZEROS: u64 = 1 << 24;

/// The positions of an accessor, checked to be finite.
pub(super) fn positions(
    buffers: &mut Buffers<'_, '_>,
    index: usize,
    user: &Place,
) -> Result<Vec<[f64; 3]>, Damage> {
    let accessor = accessor(buffers, index, user)?;
    let place = Place::Item {
        list: "accessor",
        index: index as u64,
    };
    if accessor.kind != "VEC3" {
        let found = format!("positions of type {:?}, expected \"VEC3\"", accessor.kind);
        return Err(Damage::broken(place, found));
    }
    let kind = Component::parse(accessor.component_type, accessor.normalized, &place)?;
    let mut out = vec![[0.0; 3]; element_count(accessor, &place, kind.size() * 3, buffers)?];
    if let Some(view) = accessor.buffer_view {
        let view = buffers.view(view, &place)?;
        let elements = Elements::new(
            &view,
            accessor.byte_offset,
            out.len(),
            kind.size() * 3,
            &place,
        )?;
        for (point, bytes) in out.iter_mut().zip(elements) {
            *point = vec3(kind, bytes);
        }
    }
    if let Some(sparse) = &accessor.sparse {
        let targets = sparse_targets(buffers, sparse, out.len(), &place)?;
        let view = buffers.view(sparse.values.buffer_view, &place)?;
        let view = View {
            stride: None,
            ..view
        };
        let values = Elements::new(
            &view,
            sparse.values.byte_offset,
            targets.len(),
            kind.size() * 3,
            &place,
        )?;
        for (target, bytes) in targets.into_iter().zip(values) {
            out[target] = vec3(kind, bytes);
        }
    }
    for (i, point) in out.iter().enumerate() {
        check_finite(*point, || place.clone(), i as u64)?;
    }
    Ok(out)
}

/// The vertex indices of an accessor; whether they exist is for the mesh to check.
pub(super) fn indices(
    buffers: &mut Buffers<'_, '_>,
    index: usize,
    user: &Place,
) -> Result<Vec<u32>, Damage> {
    let accessor = accessor(buffers, index, user)?;
    let place = Place::Item {
        list: "accessor",
        index: index as u64,
    };
    if accessor.kind != "SCALAR" {
        let found = format!("indices of type {:?}, expected \"SCALAR\"", accessor.kind);
        return Err(Damage::broken(place, found));
    }
    let kind = Component::parse(accessor.component_type, false, &place)?;
    let size = kind.index_size(&place)?;
    let mut out = vec![0; element_count(accessor, &place, size, buffers)?];
    if let Some(view) = accessor.buffer_view {
        let view = buffers.view(view, &place)?;
        let elements = Elements::new(&view, accessor.byte_offset, out.len(), size, &place)?;
        for (value, bytes) in out.iter_mut().zip(elements) {
            *value = unsigned(bytes);
        }
    }
    if let Some(sparse) = &accessor.sparse {
        let targets = sparse_targets(buffers, sparse, out.len(), &place)?;
        let view = buffers.view(sparse.values.buffer_view, &place)?;
        let view = View {
            stride: None,
            ..view
        };
        let values = Elements::new(
            &view,
            sparse.values.byte_offset,
            targets.len(),
            size,
            &place,
        )?;
        for (target, bytes) in targets.into_iter().zip(values) {
            out[target] = unsigned(bytes);
        }
    }
    Ok(out)
}

fn accessor<'a>(
    buffers: &Buffers<'a, '_>,
    index: usize,
    user: &Place,
) -> Result<&'a Accessor, Damage> {
    let accessors = &buffers.document.accessors;
    accessors.get(index).ok_or_else(|| {
        let found = format!(
            "accessor {index} does not exist, there are {}",
            accessors.len()
        );
        Damage::broken(user.clone(), found)
    })
}

/// The number of elements, once it is certain that memory for them may be set aside: there are
/// bytes behind them, or they are few.
fn element_count(
    accessor: &Accessor,
    place: &Place,
    size: usize,
    buffers: &mut Buffers<'_, '_>,
) -> Result<usize, Damage> {
    let room = match accessor.buffer_view {
        Some(view) => {
            let view = buffers.view(view, place)?;
            (view.bytes.len() / view.stride.unwrap_or(size).clamp(1, size)) as u64
        }
        None => MOST_ZEROS,
    };
    if accessor.count > room {
        let found = format!(
            "{} elements, but its bufferView has room for {room} at most",
            accessor.count
        );
        return Err(Damage::broken(place.clone(), found));
    }
    Ok(accessor.count as usize)
}

fn sparse_targets(
    buffers: &mut Buffers<'_, '_>,
    sparse: &Sparse,
    elements: usize,
    place: &Place,
) -> Result<Vec<usize>, Damage> {
    let kind = Component::parse(sparse.indices.component_type, false, place)?;
    let size = kind.index_size(place)?;
    let count = usize::try_from(sparse.count).unwrap_or(usize::MAX);
    let view = buffers.view(sparse.indices.buffer_view, place)?;
    let view = View {
        stride: None,
        ..view
    };
    let targets: Vec<usize> = Elements::new(&view, sparse.indices.byte_offset, count, size, place)?
        .map(|bytes| unsigned(bytes) as usize)
        .collect();
    match targets.iter().find(|t| **t >= elements) {
        Some(bad) => {
            let found = format!("a sparse value for element {bad}, there are {elements}");
            Err(Damage::broken(place.clone(), found))
        }
        None => Ok(targets),
    }
}

/// The elements of an accessor as byte slices, all checked to be inside the view.
struct Elements<'b> {
    bytes: &'b [u8],
    stride: usize,
    size: usize,
    left: usize,
}

impl<'b> Elements<'b> {
    fn new(
        view: &View<'b>,
        offset: u64,
        count: usize,
        size: usize,
        place: &Place,
    ) -> Result<Self, Damage> {
        let stride = view.stride.unwrap_or(size);
        if stride < size {
            let found = format!("elements of {size} bytes, but a byteStride of {stride}");
            return Err(Damage::broken(place.clone(), found));
        }
        let offset = usize::try_from(offset).unwrap_or(usize::MAX);
        let needed = match count.checked_sub(1) {
            None => Some(0),
            Some(last) => last.checked_mul(stride).and_then(|n| n.checked_add(size)),
        };
        let end = needed.and_then(|n| n.checked_add(offset));
        match end {
            Some(end) if end <= view.bytes.len() => Ok(Self {
                bytes: &view.bytes[offset..end],
                stride,
                size,
                left: count,
            }),
            _ => {
                let found = format!(
                    "{count} elements from byte {offset} on do not fit its bufferView of {} bytes",
                    view.bytes.len()
                );
                Err(Damage::broken(place.clone(), found))
            }
        }
    }
}

impl<'b> Iterator for Elements<'b> {
    type Item = &'b [u8];

    fn next(&mut self) -> Option<&'b [u8]> {
        self.left = self.left.checked_sub(1)?;
        let element = &self.bytes[..self.size];
        self.bytes = self.bytes.get(self.stride..).unwrap_or_default();
        Some(element)
    }
}

/// How one number is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Component {
    I8(f64),
    U8(f64),
    I16(f64),
    U16(f64),
    U32,
    F32,
}

impl Component {
    /// The integer kinds carry the divisor that normalizes them.
    fn parse(code: u32, normalized: bool, place: &Place) -> Result<Self, Damage> {
        let divisor = |d| if normalized { d } else { 1.0 };
        Ok(match code {
            5120 => Self::I8(divisor(127.0)),
            5121 => Self::U8(divisor(255.0)),
            5122 => Self::I16(divisor(32767.0)),
            5123 => Self::U16(divisor(65535.0)),
            5125 => Self::U32,
            5126 => Self::F32,
            _ => {
                return Err(Damage::broken(
                    place.clone(),
                    format!("componentType {code} does not exist"),
                ));
            }
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8(_) | Self::U8(_) => 1,
            Self::I16(_) | Self::U16(_) => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    fn index_size(self, place: &Place) -> Result<usize, Damage> {
        match self {
            Self::U8(_) | Self::U16(_) | Self::U32 => Ok(self.size()),
            _ => {
                let found =
                    "indices that are not unsigned integers (componentType 5121, 5123 or 5125)";
                Err(Damage::broken(place.clone(), found))
            }
        }
    }

    fn value(self, bytes: &[u8]) -> f64 {
        let two = || [bytes[0], bytes[1]];
        let four = || [bytes[0], bytes[1], bytes[2], bytes[3]];
        match self {
            Self::I8(divisor) => {
                (f64::from(i8::from_le_bytes([bytes[0]])) / divisor).max(least(divisor))
            }
            Self::U8(divisor) => f64::from(bytes[0]) / divisor,
            Self::I16(divisor) => {
                (f64::from(i16::from_le_bytes(two())) / divisor).max(least(divisor))
            }
            Self::U16(divisor) => f64::from(u16::from_le_bytes(two())) / divisor,
            Self::U32 => f64::from(u32::from_le_bytes(four())),
            Self::F32 => f64::from(f32::from_le_bytes(four())),
        }
    }
}

/// Normalized signed integers stop at -1; the others are free.
fn least(divisor: f64) -> f64 {
    if divisor > 1.0 {
        -1.0
    } else {
        f64::NEG_INFINITY
    }
}

fn vec3(kind: Component, bytes: &[u8]) -> [f64; 3] {
    let n = kind.size();
    [
        kind.value(&bytes[..n]),
        kind.value(&bytes[n..2 * n]),
        kind.value(&bytes[2 * n..3 * n]),
    ]
}

/// A little-endian unsigned integer of one, two or four bytes.
fn unsigned(bytes: &[u8]) -> u32 {
    bytes
        .iter()
        .rev()
        .fold(0, |value, byte| value << 8 | u32::from(*byte))
}
