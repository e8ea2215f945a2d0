//! The buffers of a glTF file, fetched when first needed: the binary chunk, `data:` URIs, files.

use std::borrow::Cow;

use base64::Engine;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use super::document::Document;
use crate::error::{Damage, Place};
use crate::read::Resolver;

/// Base64 as found in files: with or without padding.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

pub(super) struct Buffers<'a, 'r> {
    pub(super) document: &'a Document,
    binary_chunk: Option<&'a [u8]>,
    resolve: &'r mut Resolver<'r>,
    loaded: Vec<Option<Cow<'a, [u8]>>>,
}

/// A run of bytes inside a buffer: a buffer view.
pub(super) struct View<'b> {
    pub(super) bytes: &'b [u8],
    pub(super) stride: Option<usize>,
}

impl<'a, 'r> Buffers<'a, 'r> {
    pub(super) fn new(
        document: &'a Document,
        binary_chunk: Option<&'a [u8]>,
        resolve: &'r mut Resolver<'r>,
    ) -> Self {
        let loaded = vec![None; document.buffers.len()];
        Self {
            document,
            binary_chunk,
            resolve,
            loaded,
        }
    }

    /// The bytes of a buffer view; `user` is who asks, for messages.
    pub(super) fn view(&mut self, index: usize, user: &Place) -> Result<View<'_>, Damage> {
        let views = &self.document.buffer_views;
        let view = views.get(index).ok_or_else(|| {
            let found = format!(
                "bufferView {index} does not exist, there are {}",
                views.len()
            );
            Damage::broken(user.clone(), found)
        })?;
        let buffer = self.buffer(view.buffer, index)?;
        let range = view
            .byte_offset
            .checked_add(view.byte_length)
            .and_then(|end| {
                let (start, end) = (
                    usize::try_from(view.byte_offset).ok()?,
                    usize::try_from(end).ok()?,
                );
                buffer.get(start..end)
            });
        let bytes = range.ok_or_else(|| {
            let found = format!(
                "{} bytes from byte {} on do not fit buffer {} of {} bytes",
                view.byte_length,
                view.byte_offset,
                view.buffer,
                buffer.len()
            );
            Damage::broken(
                Place::Item {
                    list: "bufferView",
                    index: index as u64,
                },
                found,
            )
        })?;
        let stride = view
            .byte_stride
            .map(|s| usize::try_from(s).unwrap_or(usize::MAX));
        Ok(View { bytes, stride })
    }

    fn buffer(&mut self, index: usize, view: usize) -> Result<&[u8], Damage> {
        let count = self.loaded.len();
        if index >= count {
            let place = Place::Item {
                list: "bufferView",
                index: view as u64,
            };
            return Err(Damage::broken(
                place,
                format!("buffer {index} does not exist, there are {count}"),
            ));
        }
        if self.loaded[index].is_none() {
            let bytes = self.load(index)?;
            self.loaded[index] = Some(bytes);
        }
        Ok(self.loaded[index].as_deref().unwrap_or_default())
    }

    fn load(&mut self, index: usize) -> Result<Cow<'a, [u8]>, Damage> {
        let place = Place::Item {
            list: "buffer",
            index: index as u64,
        };
        let buffer = &self.document.buffers[index];
        let bytes: Cow<'a, [u8]> = match &buffer.uri {
            None => Cow::Borrowed(self.binary_chunk.filter(|_| index == 0).ok_or_else(|| {
                Damage::broken(
                    place.clone(),
                    "it has no URI, and the file has no binary chunk for it",
                )
            })?),
            Some(uri) if uri.starts_with("data:") => {
                Cow::Owned(data_uri(uri).map_err(|found| Damage::broken(place.clone(), found))?)
            }
            Some(uri) if uri.contains("://") => {
                let found = format!("its data lies at {uri:?}");
                return Err(Damage::new(
                    place,
                    found,
                    "download it and refer to it by a relative path",
                ));
            }
            Some(uri) => Cow::Owned((self.resolve)(&percent_decoded(uri)).map_err(|cause| {
                Damage::new(
                    place.clone(),
                    format!("the file {uri:?} beside it cannot be read ({cause})"),
                    "put it beside the scene, or export one GLB file",
                )
            })?),
        };
        if (bytes.len() as u64) < buffer.byte_length {
            let found = format!(
                "{} bytes are promised, but there are {}",
                buffer.byte_length,
                bytes.len()
            );
            return Err(Damage::broken(place, found));
        }
        Ok(bytes)
    }
}

fn data_uri(uri: &str) -> Result<Vec<u8>, String> {
    let (head, data) = uri.split_once(',').ok_or("a data: URI without a comma")?;
    if !head.ends_with(";base64") {
        return Err("a data: URI that is not base64".to_owned());
    }
    BASE64
        .decode(data.trim())
        .map_err(|error| format!("damaged base64 in a data: URI ({error})"))
}

/// URIs write unusual characters as `%20`.
fn percent_decoded(uri: &str) -> String {
    let mut out = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&byte, tail)) = rest.split_first() {
        let hex = (byte == b'%').then(|| tail.get(..2)).flatten();
        let code = hex.and_then(|h| u8::from_str_radix(std::str::from_utf8(h).ok()?, 16).ok());
        out.push(code.unwrap_or(byte));
        rest = if code.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8(out).unwrap_or_else(|_| uri.to_owned())
}

#[cfg(test)]
mod tests {
    use super::{data_uri, percent_decoded};

    #[test]
    fn uris_are_decoded() {
        assert_eq!(percent_decoded("a%20b%c3%a9%2.bin%"), "a bé%2.bin%");
        assert_eq!(
            data_uri("data:application/octet-stream;base64,AQID"),
            Ok(vec![1, 2, 3])
        );
        assert_eq!(data_uri("data:;base64,AQ"), Ok(vec![1]));
        assert!(data_uri("data:text/plain,hi").is_err() && data_uri("data:;base64,*").is_err());
    }
}
