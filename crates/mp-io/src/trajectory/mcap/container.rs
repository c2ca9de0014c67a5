//! The container: records of [MCAP](https://mcap.dev/spec), version 0. Numbers are little-endian.

use super::{WHAT, error};
use mp_formats::error::Error;
use std::io::Read;

/// What files begin and end with.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// The numbers of the records that are written or read.
const HEADER: u8 = 0x01;
const FOOTER: u8 = 0x02;
const SCHEMA: u8 = 0x03;
const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const CHUNK: u8 = 0x06;
const MESSAGE_INDEX: u8 = 0x07;
const CHUNK_INDEX: u8 = 0x08;
const STATISTICS: u8 = 0x0B;
const DATA_END: u8 = 0x0F;

/// Chunks may hold no more bytes than this, in sum, once they are unpacked.
const MOST: u64 = 512 << 20;

/// A kind of message: its topic, the name of its type, and the definition of that.
pub(super) struct Topic {
    pub(super) name: &'static str,
    pub(super) schema: &'static str,
    pub(super) definition: String,
}

/// A message to be written: the index of its topic, its time (ns), and its bytes.
pub(super) struct Message {
    pub(super) topic: usize,
    pub(super) time: u64,
    pub(super) bytes: Vec<u8>,
}

fn text(out: &mut Vec<u8>, text: &str) {
    block(out, text.as_bytes());
}

fn block(out: &mut Vec<u8>, bytes: &[u8]) {
    out.extend((bytes.len() as u32).to_le_bytes());
    out.extend(bytes);
}

fn record(out: &mut Vec<u8>, kind: u8, content: &[u8]) {
    out.push(kind);
    out.extend((content.len() as u64).to_le_bytes());
    out.extend(content);
}

/// Numbers of several widths, one after another.
macro_rules! bytes {
    ($($x:expr),*) => {{ let mut out = Vec::new(); $(out.extend($x.to_le_bytes());)* out }};
}

/// A file with messages in the order of their times: one chunk with an index, and what players ask first at the end.
pub(super) fn written(topics: &[Topic], messages: &[Message]) -> Vec<u8> {
    let mut of_topics = Vec::new();
    for (i, topic) in topics.iter().enumerate() {
        let id = i as u16 + 1;
        let mut schema = bytes![id];
        text(&mut schema, topic.schema);
        text(&mut schema, "ros2msg");
        block(&mut schema, topic.definition.as_bytes());
        record(&mut of_topics, SCHEMA, &schema);
        let mut channel = bytes![id, id];
        text(&mut channel, topic.name);
        text(&mut channel, "cdr");
        block(&mut channel, &[]);
        record(&mut of_topics, CHANNEL, &channel);
    }
    let [first, last] = [messages.first(), messages.last()].map(|m| m.map_or(0, |m| m.time));

    let mut records = of_topics.clone();
    let mut indexes = vec![Vec::new(); topics.len()];
    for message in messages {
        indexes[message.topic].extend(bytes![message.time, records.len() as u64]);
        let sequence = (indexes[message.topic].len() / 16) as u32;
        let mut content = bytes![message.topic as u16 + 1, sequence, message.time, message.time];
        content.extend(&message.bytes);
        record(&mut records, MESSAGE, &content);
    }
    let mut out = MAGIC.to_vec();
    let mut header = Vec::new();
    text(&mut header, "ros2");
    text(&mut header, concat!("mp ", env!("CARGO_PKG_VERSION")));
    record(&mut out, HEADER, &header);

    let size = records.len() as u64;
    let mut chunk = bytes![first, last, size, 0_u32];
    text(&mut chunk, "");
    chunk.extend(size.to_le_bytes());
    chunk.extend(&records);
    let chunk_at = out.len() as u64;
    record(&mut out, CHUNK, &chunk);
    let chunk_length = out.len() as u64 - chunk_at;
    let (indexes_at, mut offsets, mut counts) = (out.len() as u64, Vec::new(), Vec::new());
    for (i, index) in indexes.iter().enumerate() {
        let id = i as u16 + 1;
        offsets.extend(bytes![id, out.len() as u64]);
        counts.extend(bytes![id, (index.len() / 16) as u64]);
        let mut content = bytes![id];
        block(&mut content, index);
        record(&mut out, MESSAGE_INDEX, &content);
    }
    let indexes_length = out.len() as u64 - indexes_at;
    record(&mut out, DATA_END, &bytes![0_u32]);

    let summary = out.len() as u64;
    out.extend(&of_topics);
    let number = topics.len();
    let mut statistics =
        bytes![messages.len() as u64, number as u16, number as u32, 0_u32, 0_u32, 1_u32, first, last];
    block(&mut statistics, &counts);
    record(&mut out, STATISTICS, &statistics);
    let mut index = bytes![first, last, chunk_at, chunk_length];
    block(&mut index, &offsets);
    index.extend(indexes_length.to_le_bytes());
    text(&mut index, "");
    index.extend(bytes![size, size]);
    record(&mut out, CHUNK_INDEX, &index);
    record(&mut out, FOOTER, &bytes![summary, 0_u64, 0_u32]);
    out.extend(MAGIC);
    out
}

/// A message of a file.
pub(super) struct Recorded {
    pub(super) topic: String,
    /// The name of its type: `sensor_msgs/msg/JointState`.
    pub(super) schema: String,
    /// How it is written: `cdr`, `json`, …
    pub(super) encoding: String,
    /// When it was logged (ns).
    pub(super) time: u64,
    pub(super) bytes: Vec<u8>,
}

/// Numbers and texts in the content of a record.
struct Content<'a>(&'a [u8]);

impl<'a> Content<'a> {
    fn take(&mut self, count: u64) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(usize::try_from(count).ok()?)?;
        self.0 = rest;
        Some(taken)
    }
    fn u16(&mut self) -> Option<u16> {
        Some(u16::from_le_bytes(self.take(2)?.try_into().ok()?))
    }
    fn u32(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.take(4)?.try_into().ok()?))
    }
    fn u64(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(self.take(8)?.try_into().ok()?))
    }
    fn text(&mut self) -> Option<String> {
        let length = self.u32()?;
        Some(String::from_utf8_lossy(self.take(u64::from(length))?).into_owned())
    }
    /// The next record: its kind and its content.
    fn record(&mut self) -> Option<(u8, Content<'a>)> {
        let kind = self.take(1)?[0];
        let length = self.u64()?;
        Some((kind, Content(self.take(length)?)))
    }
}

/// What is read so far.
#[derive(Default)]
struct Reading {
    schemas: Vec<(u16, String)>,
    /// The number, the schema, the topic and the encoding of each channel.
    channels: Vec<(u16, u16, String, String)>,
    messages: Vec<Recorded>,
    unpacked: u64,
}

/// The messages whose type `wanted` knows, in the order of the file.
///
/// # Errors
/// When it is no such file, ends too early, or is compressed by what is not known here.
pub(super) fn messages(file: &str, bytes: &[u8], wanted: fn(&str) -> bool) -> Result<Vec<Recorded>, Error> {
    let Some(bytes) = bytes.strip_prefix(MAGIC) else {
        return Err(error(file, "it does not begin as MCAP does".to_owned()).expected(WHAT));
    };
    let mut reading = Reading::default();
    reading.records(file, Content(bytes), wanted, false)?;
    Ok(reading.messages)
}

impl Reading {
    /// Reads records. `packed` says that they are in a chunk, which must not hold further chunks.
    fn records(
        &mut self,
        file: &str,
        mut bytes: Content<'_>,
        wanted: fn(&str) -> bool,
        packed: bool,
    ) -> Result<(), Error> {
        let ends_early =
            || error(file, "it ends in the middle of a record".to_owned()).expected("a whole file");
        while !bytes.0.is_empty() {
            let (kind, mut content) = bytes.record().ok_or_else(ends_early)?;
            match kind {
                SCHEMA => {
                    let schema = content.u16().zip(content.text()).ok_or_else(ends_early)?;
                    self.schemas.push(schema);
                }
                CHANNEL => {
                    let ids = content.u16().zip(content.u16());
                    let ((id, schema), (topic, encoding)) =
                        ids.zip(content.text().zip(content.text())).ok_or_else(ends_early)?;
                    self.channels.push((id, schema, topic, encoding));
                }
                MESSAGE => {
                    let head = content.u16().zip(content.u32()).zip(content.u64().zip(content.u64()));
                    let ((id, _), (time, _)) = head.ok_or_else(ends_early)?;
                    let Some((_, schema, topic, encoding)) = self.channels.iter().find(|c| c.0 == id) else {
                        return Err(error(file, format!("a message is of channel {id}, which is not there")));
                    };
                    let Some((_, schema)) = self.schemas.iter().find(|s| s.0 == *schema) else { continue };
                    if wanted(schema) {
                        self.messages.push(Recorded {
                            topic: topic.clone(),
                            schema: schema.clone(),
                            encoding: encoding.clone(),
                            time,
                            bytes: content.0.to_vec(),
                        });
                    }
                }
                CHUNK if packed => return Err(error(file, "a chunk has chunks".to_owned())),
                CHUNK => {
                    let size = content.take(16).and_then(|_| content.u64()).ok_or_else(ends_early)?;
                    let compression = content.u32().and_then(|_| content.text()).ok_or_else(ends_early)?;
                    let packed =
                        content.u64().and_then(|length| content.take(length)).ok_or_else(ends_early)?;
                    self.unpacked = self.unpacked.saturating_add(size);
                    if self.unpacked > MOST {
                        let message = format!("its chunks say that they hold {} MB", self.unpacked >> 20);
                        return Err(error(file, message).expected(format!("{} MB at most", MOST >> 20)));
                    }
                    let unpacked = unpacked(&compression, packed, size)
                        .map_err(|why| error(file, format!("a chunk cannot be unpacked: {why}")))?;
                    self.records(file, Content(unpacked.as_deref().unwrap_or(packed)), wanted, true)?;
                }
                // What follows only repeats what was there.
                DATA_END | FOOTER => return Ok(()),
                _ => {}
            }
        }
        Ok(())
    }
}

/// The content of a chunk; `None` if it is not compressed.
fn unpacked(compression: &str, packed: &[u8], size: u64) -> Result<Option<Vec<u8>>, String> {
    let mut out = Vec::new();
    let mut read = |from: &mut dyn Read| from.take(size).read_to_end(&mut out).map_err(|e| e.to_string());
    match compression {
        "" => return Ok(None),
        "lz4" => read(&mut lz4_flex::frame::FrameDecoder::new(packed))?,
        "zstd" => read(&mut ruzstd::decoding::StreamingDecoder::new(packed).map_err(|e| e.to_string())?)?,
        other => return Err(format!("`{}` is not known", mp_formats::text::clipped(other))),
    };
    Ok(Some(out))
}
