//! Roadmaps for other programs: GraphML and DOT.

use super::{LinkState, Roadmap};
use mp_cspace::StateVector;
use std::fmt::Write;

impl<S: StateVector, E> Roadmap<S, E> {
    /// The numbers of a state, separated by spaces.
    fn written(&self, index: usize) -> String {
        let mut numbers = Vec::new();
        self.states()[index].write(&mut numbers);
        let mut text = String::new();
        for (i, x) in numbers.iter().enumerate() {
            let _ = write!(text, "{}{x}", if i == 0 { "" } else { " " });
        }
        text
    }

    /// The roadmap as GraphML (Brandes et al. 2002), which Gephi, yEd, networkx and igraph read: nodes with
    /// state, kind and obstacle, edges with length and state.
    #[must_use]
    pub fn to_graphml(&self) -> String {
        let mut text = String::from(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n",
        );
        for (id, of, kind) in [
            ("state", "node", "string"),
            ("kind", "node", "string"),
            ("obstacle", "node", "int"),
            ("length", "edge", "double"),
            ("checked", "edge", "string"),
        ] {
            let _ =
                writeln!(text, "  <key id=\"{id}\" for=\"{of}\" attr.name=\"{id}\" attr.type=\"{kind}\"/>");
        }
        text.push_str("  <graph edgedefault=\"undirected\">\n");
        for (i, tag) in self.tags().enumerate() {
            let _ = write!(text, "    <node id=\"n{i}\"><data key=\"state\">{}</data>", self.written(i));
            let _ = write!(text, "<data key=\"kind\">{}</data>", tag.kind.name());
            if let Some(obstacle) = tag.obstacle {
                let _ = write!(text, "<data key=\"obstacle\">{obstacle}</data>");
            }
            text.push_str("</node>\n");
        }
        for (_, [a, b], link) in self.all_edges() {
            let _ = write!(text, "    <edge source=\"n{a}\" target=\"n{b}\">");
            let _ = writeln!(
                text,
                "<data key=\"length\">{}</data><data key=\"checked\">{}</data></edge>",
                link.length,
                word(link.state)
            );
        }
        text.push_str("  </graph>\n</graphml>\n");
        text
    }

    /// The roadmap in the DOT language of Graphviz; blocked edges dotted, unchecked ones dashed.
    #[must_use]
    pub fn to_dot(&self) -> String {
        let mut text = String::from("graph {\n");
        for (i, tag) in self.tags().enumerate() {
            let (kind, state) = (tag.kind.name(), self.written(i));
            let _ = writeln!(text, "    {i} [label=\"{i}\" kind=\"{kind}\" state=\"{state}\"]");
        }
        for (_, [a, b], link) in self.all_edges() {
            let style = match link.state {
                LinkState::Unchecked => "dashed",
                LinkState::Free => "solid",
                LinkState::Blocked => "dotted",
            };
            let _ = writeln!(text, "    {a} -- {b} [len={} style={style}]", link.length);
        }
        text.push_str("}\n");
        text
    }
}

fn word(state: LinkState) -> &'static str {
    match state {
        LinkState::Unchecked => "unchecked",
        LinkState::Free => "free",
        LinkState::Blocked => "blocked",
    }
}
