use std::time::Instant;
#[test]
fn all() {
    let dir = std::path::PathBuf::from(std::env::var("SELFLINK_SCENES").unwrap());
    for file in ["cornell-box/CornellBox-Original.obj","cornell-box/CornellBox-Sphere.obj","cornell-box/CornellBox-bevy.glb","veach-ajar/veach-ajar.obj","fireplace-room/fireplace-room.obj","classroom/classroom.glb"] {
        let t = Instant::now();
        match selflink::scene::load_file(&dir.join(file)) {
            Ok(s) => {
                eprintln!("{file}: {} polys ({} quads) {} verts {} mats {} groups, bounds {:?} power {:?} {:?}", s.polygons.len(), s.polygons.iter().filter(|p| p.is_quad()).count(), s.vertices.len(), s.materials.len(), s.groups.len(), s.bounds(), s.emitted_power(), t.elapsed());
                for l in s.skipped.sentences() { eprintln!("   {l}"); }
            }
            Err(e) => eprintln!("{file}: {e}"),
        }
    }
}
