//! scratch
#[test]
fn all() {
    let only = std::env::var("ROW").ok();
    for row in selflink::stability::rows() {
        if only.as_deref().is_some_and(|only| !only.split(',').any(|o| row.number.to_string() == o)) { continue; }
        let f = row.run().expect("runs");
        println!("== {} {} {:?} {:.2}s", f.number, f.name, f.verdict, f.seconds);
        for c in &f.checks { println!("   {:?} {} truth {:.6} ours {:.6} ({:+.3} %)", c.verdict(), c.what, c.truth, c.ours, 100.0*(c.ours/c.truth-1.0)); }
    }
}
