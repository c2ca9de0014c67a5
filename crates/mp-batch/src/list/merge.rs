//! Results of all shards of a list, merged to those of the whole.

use super::reader::{Next, ResultsReader};
use super::results::{end_line, line};
use super::run::open;
use super::{ResultsHeader, Shard, Tally};
use mp_io::shortened;
use mp_plan::Error;
use mp_store::Lock;
use std::io::BufRead;
use std::path::Path;
use xxhash_rust::xxh3::Xxh3;

/// Merges the results of all shards of a list, given in any order, into the file `out`: it has the bytes of a
/// run of all items.
///
/// # Errors
/// When a shard is missing, is there twice, is not complete or damaged, or is of another list, version, scene
/// or options than the others: with its name, and the command that makes it again. When a file cannot be
/// read, or `out` cannot be written; it is then as before.
pub fn merge_results<P: AsRef<Path>>(out: &Path, shards: &[P]) -> Result<Tally, Error> {
    let readers = shards.iter().map(|file| open(file.as_ref())).collect::<Result<_, _>>()?;
    mp_store::make_folder(mp_store::folder_of(out))?;
    let _lock = Lock::of_file(out)?;
    let mut merged = merged(readers)?;
    mp_store::write_parts(out, &mut merged)?;
    Ok(merged.tally)
}

/// Merges results.
///
/// # Errors
/// When they are not all shards of one list, each once. What is wrong further down is an error among the
/// lines.
pub(crate) fn merged<R: BufRead>(mut shards: Vec<ResultsReader<R>>) -> Result<Merged<R>, Error> {
    let Some(first) = shards.first() else {
        return Err(Error::new("there is no shard to merge").help("name the files of all shards"));
    };
    let (header, name) = (first.header.clone(), shortened(&first.name, 80));
    let of = header.shard.of();
    for shard in &shards {
        let other = match shard.header.shard {
            there if there.of() != of => Some(format!("it is of {} shards, not {of}", there.of())),
            _ => shard.header.difference(&header),
        };
        if let Some(other) = other {
            let message = format!("{} does not fit to {name}: {other}", shortened(&shard.name, 80));
            let index = shard.header.shard.index().min(of);
            return Err(again(message, &header, Shard::new(index, of)?, &shard.name));
        }
    }
    shards.sort_by_key(|shard| shard.header.shard.index());
    if let Some([a, b]) = shards.array_windows().find(|[a, b]| a.header.shard == b.header.shard) {
        let [one, other] = [a, b].map(|shard| shortened(&shard.name, 80));
        let message = format!("shard {} is there twice: {one} and {other}", a.header.shard);
        return Err(Error::new(message).help(match missing(&shards, of) {
            Some(shard) => format!("leave one out; shard {shard} is made by {}", made(&header, shard)),
            None => "leave one out".to_owned(),
        }));
    }
    if let Some(shard) = missing(&shards, of) {
        let message = format!("shard {shard} is missing");
        return Err(Error::new(message).help(format!("name its file, or make it: {}", made(&header, shard))));
    }
    let header = ResultsHeader { shard: Shard::WHOLE, ..header };
    Ok(Merged { shards, header, next: Part::Header, hash: Xxh3::new(), tally: Tally::default() })
}

/// The first shard that is not there, of sorted ones.
fn missing<R>(shards: &[ResultsReader<R>], of: u32) -> Option<Shard> {
    let there = |index: &u32| shards.binary_search_by_key(index, |shard| shard.header.shard.index()).is_ok();
    (1..=of).find(|index| !there(index)).and_then(|index| Shard::new(index, of).ok())
}

/// The command that makes a shard whose file is not known.
fn made(header: &ResultsHeader, shard: Shard) -> String {
    header.command(shard, &format!("shard-{}-of-{}.jsonl", shard.index(), shard.of()))
}

/// An error about the file of a shard that must be made again.
fn again(message: String, header: &ResultsHeader, shard: Shard, file: &str) -> Error {
    Error::new(message).help(format!("delete it, and make it again: {}", header.command(shard, file)))
}

/// The lines of merged results.
pub(crate) struct Merged<R> {
    shards: Vec<ResultsReader<R>>,
    header: ResultsHeader,
    next: Part,
    hash: Xxh3,
    pub(crate) tally: Tally,
}

enum Part {
    Header,
    Item(u64),
    Nothing,
}

impl<R: BufRead> Merged<R> {
    /// The next line, and what follows it.
    fn part(&mut self) -> Result<(Vec<u8>, Part), Error> {
        match self.next {
            Part::Header => Ok((line(&self.header)?.into(), Part::Item(0))),
            Part::Item(item) if item < self.header.items => {
                let of = self.shards.len() as u64;
                let shard = &mut self.shards[(item % of) as usize];
                match read(shard)? {
                    Next::Item(result) => self.tally += result.tally(),
                    // It has fewer items than its header says: the reader refuses that.
                    Next::End | Next::Cut => return Err(incomplete(shard)),
                }
                Ok((shard.line().to_vec(), Part::Item(item + 1)))
            }
            Part::Item(_) => {
                for shard in &mut self.shards {
                    match read(shard)? {
                        Next::End => {}
                        Next::Item(_) | Next::Cut => return Err(incomplete(shard)),
                    }
                }
                Ok((end_line(self.tally, &self.hash)?.into(), Part::Nothing))
            }
            Part::Nothing => Ok((Vec::new(), Part::Nothing)),
        }
    }
}

impl<R: BufRead> Iterator for Merged<R> {
    type Item = Result<Vec<u8>, Error>;
    fn next(&mut self) -> Option<Self::Item> {
        if let Part::Nothing = self.next {
            return None;
        }
        let part = self.part();
        let (line, next) = match part {
            Ok((line, next)) => (Ok(line), next),
            Err(e) => (Err(e), Part::Nothing),
        };
        self.next = next;
        if let Ok(line) = &line {
            self.hash.update(line);
        }
        Some(line)
    }
}

/// Reads the next line of a shard. The error says how to make the shard again.
fn read<R: BufRead>(shard: &mut ResultsReader<R>) -> Result<Next, Error> {
    let next = shard.read();
    next.map_err(|e| again(e.to_string(), &shard.header, shard.header.shard, &shard.name))
}

/// The error about a shard whose log was cut off.
pub(super) fn incomplete<R: BufRead>(shard: &ResultsReader<R>) -> Error {
    let (name, header) = (shortened(&shard.name, 120), &shard.header);
    let (items, all) = (shard.tally.items, shard.expected());
    Error::new(format!("{name}, shard {}, is not complete: it has {items} of {all} items", header.shard))
        .help(format!("go on with it: {}", header.command(header.shard, &shard.name)))
}
