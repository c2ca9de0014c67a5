//! x
use mp_soak::trial::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let n: u64 = a[1].parse().unwrap();
    let wanted = Wanted { kind: a.get(2).cloned().filter(|k| k != "-"), planner: None };
    let mut by = std::collections::BTreeMap::<(String, String), (u64, f64)>::new();
    let mut slow = Vec::new();
    for i in 0..n {
        let t = std::time::Instant::now();
        let p = Problem::new(1, i, &wanted);
        let g = t.elapsed().as_secs_f64();
        let r = p.run(&wanted);
        let s = t.elapsed().as_secs_f64();
        slow.push((s, g, i, r.kind, r.planner.clone(), r.judged.as_ref().map(|j| j.tests)));
        for f in &r.findings { eprintln!("{i} {} {}: {} {}", r.kind, r.planner, f.sort, &f.what.chars().take(400).collect::<String>()); }
        let e = by.entry((r.kind.to_string(), format!("{:?}{}", r.outcome, if r.findings.is_empty(){""}else{" FINDING"}))).or_default();
        e.0 += 1; e.1 += s;
        if a.len() > 3 { if let Some(r) = r.refusal { eprintln!("{i} {}: {r}", p.kind.name); } }
    }
    for (k, v) in by { println!("{:15} {:25} {:6} {:.1} ms", k.0, k.1, v.0, 1e3 * v.1 / v.0 as f64); }
    slow.sort_by(|a, b| b.0.total_cmp(&a.0));
    for s in slow.iter().take(12) { println!("{s:?}"); }
    println!("{}", slow.iter().map(|s| s.0).sum::<f64>() / n as f64);
}
