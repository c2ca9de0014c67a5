//! Saved trees: serializing them is a feature of `mp-tree` that no other crate here uses.

/// Reads any bytes. The error is the one that refuses them.
pub(crate) type Target = fn(&[u8]) -> Result<(), serde_json::Error>;

/// What is read: a name, and the function to call.
pub(crate) const TARGETS: [(&str, Target); 1] = [("tree", tree)];

/// Saved trees in JSON.
pub(crate) fn tree(bytes: &[u8]) -> Result<(), serde_json::Error> {
    type Tree = mp_tree::Tree<Vec<f64>, f64>;
    let tree: Tree = serde_json::from_slice(bytes)?;
    let written = serde_json::to_string(&tree)?;
    let again: Tree = serde_json::from_str(&written).unwrap_or_else(|e| panic!("{e}: {written}"));
    assert_eq!(serde_json::to_string(&again)?, written);
    Ok(())
}
