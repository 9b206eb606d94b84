//! Reads the data segments out of a wasm module: the constants that compiled code looks up.

/// The constants of a module, as one block of memory.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Data {
    /// Address of the first byte.
    pub start: u32,
    /// The bytes.
    pub bytes: Vec<u8>,
}

const DATA_SECTION: u8 = 11;
const HEADER: usize = 8;

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn byte(&mut self) -> Option<u8> {
        let byte = self.bytes.get(self.at).copied();
        self.at += 1;
        byte
    }

    /// A number in LEB128; signed ones are small and positive here.
    fn number(&mut self) -> Option<u32> {
        let (mut value, mut shift) = (0_u32, 0);
        loop {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f).checked_shl(shift)?;
            shift += 7;
            if byte & 0x80 == 0 {
                return Some(value);
            }
        }
    }
}

impl Data {
    /// The data segments of `module`; `None` if it is not a module of the expected form
    /// (active segments in memory 0 at constant addresses).
    #[must_use]
    pub fn of(module: &[u8]) -> Option<Self> {
        let mut reader = Reader {
            bytes: module,
            at: HEADER,
        };
        while reader.at < module.len() {
            let section = reader.byte()?;
            let length = reader.number()? as usize;
            let end = reader.at.checked_add(length)?;
            if section == DATA_SECTION {
                return Self::segments(&mut reader);
            }
            reader.at = end;
        }
        Some(Self::default())
    }

    fn segments(reader: &mut Reader<'_>) -> Option<Self> {
        let mut out: Option<Self> = None;
        for _ in 0..reader.number()? {
            // Flag 0, i32.const ADDRESS, end.
            if reader.number()? != 0 || reader.byte()? != 0x41 {
                return None;
            }
            let address = reader.number()?;
            if reader.byte()? != 0x0b {
                return None;
            }
            let length = reader.number()? as usize;
            let bytes = reader
                .bytes
                .get(reader.at..reader.at.checked_add(length)?)?;
            reader.at += length;
            let all = out.get_or_insert_with(|| Self {
                start: address,
                bytes: Vec::new(),
            });
            let offset = address.checked_sub(all.start)? as usize;
            all.bytes.resize(all.bytes.len().max(offset + length), 0);
            all.bytes
                .get_mut(offset..offset + length)?
                .copy_from_slice(bytes);
        }
        out.or_else(|| Some(Self::default()))
    }

    /// The text of `length` bytes at `address`, for instance the file name of a panic.
    #[must_use]
    pub fn text(&self, address: u32, length: u32) -> Option<&str> {
        let from = address.checked_sub(self.start)? as usize;
        let bytes = self.bytes.get(from..from.checked_add(length as usize)?)?;
        std::str::from_utf8(bytes).ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_become_one_block() {
        let mut module = vec![0, 0x61, 0x73, 0x6d, 1, 0, 0, 0];
        let data = [
            2, 0, 0x41, 0x80, 0x20, 0x0b, 2, b'a', b'b', 0, 0x41, 0x84, 0x20, 0x0b, 1, b'c',
        ];
        module.extend([DATA_SECTION, data.len() as u8]);
        module.extend(data);
        let found = Data::of(&module).unwrap();
        assert_eq!(found.start, 4096);
        assert_eq!(found.bytes, b"ab\0\0c");
        assert_eq!(found.text(4096, 2), Some("ab"));
        assert_eq!(Data::of(&[0; 9]), None);
    }
}
