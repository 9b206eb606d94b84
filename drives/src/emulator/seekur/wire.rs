//! Packets as the robot reads and writes them, from the sheet and not from the adapter's codec: what
//! one of them gets wrong, the other must notice.

/// Finds the packets of a client; unlike a client it gives none up for lack of time.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ear {
    bytes: Vec<u8>,
}

/// A command: its number and an integer, if it has one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Heard {
    pub(crate) number: u8,
    pub(crate) value: Option<i32>,
}

impl Ear {
    pub(crate) fn hear(&mut self, bytes: &[u8]) -> Vec<Heard> {
        self.bytes.extend_from_slice(bytes);
        let mut heard = Vec::new();
        let mut at = 0;
        while let Some(rest) = self.bytes.get(at..).filter(|rest| !rest.is_empty()) {
            let length = match rest {
                [0xFA, 0xFB, length, ..] if *length >= 3 => usize::from(*length) + 3,
                [0xFA] | [0xFA, 0xFB] => break,
                _ => {
                    at += 1;
                    continue;
                }
            };
            let Some(packet) = rest.get(..length) else {
                break;
            };
            at += length;
            if let [_, _, _, body @ .., high, low] = packet
                && [*high, *low] == sum(body)
            {
                heard.extend(command(body));
            }
        }
        self.bytes.drain(..at);
        heard
    }
}

fn command(body: &[u8]) -> Option<Heard> {
    let (number, argument) = body.split_first()?;
    let value = match argument {
        [0x3B, low, high] => Some(256 * i32::from(*high) + i32::from(*low)),
        [0x1B, low, high] => Some(-(256 * i32::from(*high) + i32::from(*low))),
        _ => None,
    };
    Some(Heard {
        number: *number,
        value,
    })
}

fn sum(body: &[u8]) -> [u8; 2] {
    let mut sum = 0_u32;
    let mut index = 0;
    while index + 1 < body.len() {
        sum = (sum + 256 * u32::from(body[index]) + u32::from(body[index + 1])) % 65_536;
        index += 2;
    }
    if index < body.len() {
        sum ^= u32::from(body[index]);
    }
    [(sum / 256) as u8, (sum % 256) as u8]
}

/// Data of a packet, written field by field.
#[derive(Clone, Debug, Default)]
pub(crate) struct Data(Vec<u8>);

impl Data {
    pub(crate) fn byte(&mut self, value: u8) -> &mut Self {
        self.0.push(value);
        self
    }

    /// A word of 16 bits of either sign, low byte first.
    pub(crate) fn word(&mut self, value: i64) -> &mut Self {
        let value = value.rem_euclid(65_536);
        self.byte((value % 256) as u8).byte((value / 256) as u8)
    }

    pub(crate) fn words(&mut self, values: &[i64]) -> &mut Self {
        values.iter().fold(self, |data, value| data.word(*value))
    }

    pub(crate) fn text(&mut self, text: &str) -> &mut Self {
        self.0.extend_from_slice(text.as_bytes());
        self.byte(0)
    }

    /// The packet of this type.
    pub(crate) fn packet(&self, id: u8) -> Vec<u8> {
        let mut body = vec![id];
        body.extend_from_slice(&self.0);
        let mut packet = vec![0xFA, 0xFB, (body.len() + 2) as u8];
        packet.extend_from_slice(&body);
        packet.extend_from_slice(&sum(&body));
        packet
    }
}
