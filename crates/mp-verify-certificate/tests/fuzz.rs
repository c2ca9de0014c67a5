//! The corpora of the fuzzer for certificates and what they are compared with, and damaged copies of them:
//! docs/fuzzing.md.

#[path = "../../../fuzz/src/certificate.rs"]
mod certificate;
#[path = "../../../fuzz/damage.rs"]
mod damage;

#[test]
fn damaged_certificates_are_replayed_or_refused() {
    for (name, target) in certificate::TARGETS {
        damage::all_are_read_or_refused(name, 4000, |bytes| target(bytes).is_ok());
    }
}
