//! Pictures gathered at their pixels.

use std::sync::{Arc, OnceLock};

use glam::Vec3;
use selflink::base::cancel::CancelToken;
use selflink::base::random::hash64;
use selflink::gather::Field;
use selflink::geometry::orient;
use selflink::measure::reference::{SurfacePoint, Tracer};
use selflink::read::picture::{
    Filter, GatheredPicture, Lens, Light, PixelLight, Shading, Start, Tiles, VisibleSurfaces,
};
use selflink::read::tone::{encode_gamma, tone_curve};
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{CameraPose, GroupId, Scene, Sides};
use selflink::solve::{Solver, SolverParams};

const SIZE: [u32; 2] = [32, 24];

fn solved(scene: Scene) -> (Arc<Scene>, Arc<Field>) {
    solved_to(scene, 0.03)
}

fn solved_to(scene: Scene, error: f64) -> (Arc<Scene>, Arc<Field>) {
    let (scene, occluders) = orient::apply(scene, Sides::Front);
    let scene = Arc::new(scene);
    let params = SolverParams { error: Some(error), ..SolverParams::default() };
    let mut solver = Solver::new(scene.clone(), Arc::new(occluders), params, 1).expect("good parameters");
    solver.run(&CancelToken::new());
    let field = solver.snapshot().field.expect("a solve to an error has a field");
    (scene, field)
}

/// The inside of the Cornell box, whose own view has much black around it.
fn cornell() -> (Arc<Scene>, Arc<Field>, Lens) {
    static ROOM: OnceLock<(Arc<Scene>, Arc<Field>)> = OnceLock::new();
    let (scene, field) = ROOM.get_or_init(|| solved(BuiltinScene::Cornell.build())).clone();
    let (lower, upper) = scene.bounds();
    let at = |share: [f32; 3]| lower + Vec3::from(share) * (upper - lower);
    let pose = scene.camera.expect("ours has a view");
    let inside = CameraPose { eye: at([0.5, 0.5, 0.5]) + 0.6 * (pose.eye - at([0.5, 0.5, 0.5])), ..pose };
    let lens = Lens::of_pose(&inside, SIZE[0] as f32 / SIZE[1] as f32);
    (scene, field, lens)
}

fn picture(field: &Arc<Field>, lens: Lens, error: f32, start: Start) -> GatheredPicture {
    GatheredPicture::new(field.clone(), lens, SIZE, error, start, false)
}

fn finish(picture: &mut GatheredPicture) {
    while !picture.is_done() {
        picture.advance(&CancelToken::new()).expect("nobody cancels");
    }
}

fn shown(picture: &GatheredPicture) -> Option<Vec<[u8; 4]>> {
    picture.develop(&Shading { exposure: 1.0, read: None })
}

/// Truth: in a closed room whose walls all emit e and reflect ρ, E = e / (1 − ρ) everywhere.
#[test]
fn a_furnace_is_even() {
    let mut scene = Scene::new("furnace");
    let wall = scene.add_material("wall", Vec3::splat(0.5), Vec3::new(1.0, 2.0, 3.0));
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    for axis in 0..3 {
        for far in [0.0, 1.0] {
            let place = |u: f32, v: f32| match axis {
                0 => corner(far, u, v),
                1 => corner(v, far, u),
                _ => corner(u, v, far),
            };
            let quad = [place(0.0, 0.0), place(1.0, 0.0), place(1.0, 1.0), place(0.0, 1.0)];
            let [a, b, c, d] = quad;
            scene.add_quad(if far == 0.0 { quad } else { [a, d, c, b] }, wall, GroupId(0));
        }
    }
    let (_, field) = solved(scene);
    let pose = CameraPose { eye: Vec3::splat(0.4), target: Vec3::new(1.0, 0.7, 0.6), up: Vec3::Y, hfov_deg: 90.0 };
    let mut picture = picture(&field, Lens::of_pose(&pose, 4.0 / 3.0), 0.05, Start::Fine);
    finish(&mut picture);
    let layers = picture.layers().expect("a picture");
    let exact = Vec3::new(2.0, 4.0, 6.0);
    let off = layers.pixels.iter().map(|pixel| ((pixel.irradiance - exact) / exact).abs().max_element());
    let mut off: Vec<f32> = off.collect();
    off.sort_by(f32::total_cmp);
    // Nine tenths within the noise asked for, and as much again for the field's own error of walls
    // near corners.
    assert!(off[off.len() * 9 / 10] < 0.1, "{}", off[off.len() * 9 / 10]);
    assert!(layers.pixels.iter().all(|pixel| (pixel.coverage - 1.0).abs() < 1e-6), "a closed room covers all");
}

/// Truth: the texels of the file, a furnace's light and the layers of each other: B = B_e + ρ·E
/// with the texel's ρ.
#[test]
fn textures_are_drawn_at_full_resolution() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &[u8]| std::fs::write(folder.path().join(name), text).expect("a writable folder");
    let texels = [[188, 188, 188, 255], [0, 0, 0, 255]];
    let png = image::RgbaImage::from_fn(16, 1, |x, _| image::Rgba(texels[x as usize / 8]));
    png.save(folder.path().join("halves.png")).expect("a writable folder");
    write("a.mtl", b"newmtl wall\nKd 0.25 0.25 0.25\nKe 0.31830987 0.31830987 0.31830987\nnewmtl halves\nKd 1 1 1\nKe 0.31830987 0.31830987 0.31830987\nmap_Kd halves.png\n");
    // A unit cube seen from inside; the face at x = 1 is half grey, half black.
    let cube = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
        usemtl wall\nf 1 2 3 4\nf 6 5 8 7\nf 5 1 4 8\nf 5 6 2 1\nf 4 3 7 8\nusemtl halves\nf 2/1 6/2 7/3 3/4\n";
    write("a.obj", cube.as_bytes());
    let (_, field) = solved(selflink::scene::load_file(&folder.path().join("a.obj")).expect("a sound scene"));
    let pose = CameraPose { eye: Vec3::splat(0.5), target: Vec3::new(1.0, 0.5, 0.5), up: Vec3::Y, hfov_deg: 60.0 };
    let mut picture = picture(&field, Lens::of_pose(&pose, 4.0 / 3.0), 0.2, Start::Fine);
    finish(&mut picture);
    let layers = picture.layers().expect("a picture");
    let row = &layers.pixels[(SIZE[0] * SIZE[1] / 2) as usize..][..SIZE[0] as usize];
    let albedo: Vec<f32> = row.iter().map(|pixel| pixel.albedo.x).collect();
    // sRGB 188 is linear 0.503; only between the two middle texels are colours interpolated.
    assert!(
        (albedo[0] - 0.503).abs() < 1e-3 && albedo[31] < 1e-3 || (albedo[31] - 0.503).abs() < 1e-3 && albedo[0] < 1e-3,
        "{albedo:?}"
    );
    for pixel in row.iter().filter(|pixel| pixel.albedo.x < 1e-3 || pixel.albedo.x > 0.502) {
        let expected = Vec3::ONE + pixel.albedo * pixel.irradiance;
        assert!(pixel.radiosity.distance(expected) < 1e-3 * expected.length(), "{pixel:?}");
    }
}

/// Truth: path tracing at the very points that the pixels show; ꟻLIP of Andersson et al. 2020.
#[test]
fn a_picture_is_nearer_to_the_truth_than_paths_are() {
    let (scene, field, lens) = cornell();
    let mut picture = picture(&field, lens, 0.05, Start::Fine);
    finish(&mut picture);
    let pixels: Vec<_> =
        (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y])).map(|at| picture.at(at)).collect();
    let point = |light: &PixelLight| SurfacePoint::on(&scene, light.polygon, light.position);
    let points: Vec<SurfacePoint> = pixels.iter().flatten().map(point).collect();
    assert!(points.len() > 600, "the view is into the box: {} pixels", points.len());
    let tracer = Tracer::new(&scene);
    let of_paths = |count: u32, seed: u64| {
        let of = |(index, point)| tracer.irradiance(point, hash64(seed, index), count).as_vec3();
        (0..).zip(points.iter()).map(of).collect::<Vec<Vec3>>()
    };
    let shown = |irradiances: &[Vec3]| {
        let mut irradiances = irradiances.iter();
        let colour = |light: &Option<_>| {
            let Some(PixelLight { polygon, .. }) = light else { return [0; 3] };
            let surface = field.surface(*polygon);
            let radiosity = surface.emission + surface.reflectance * *irradiances.next().expect("one of each pixel");
            radiosity.to_array().map(|b| (255.0 * encode_gamma(tone_curve(20.0 * b))).round() as u8)
        };
        let colours: Vec<u8> = pixels.iter().flat_map(colour).collect();
        nv_flip::FlipImageRgb8::with_data(SIZE[0], SIZE[1], &colours)
    };
    let apart = |one: &[Vec3], other: &[Vec3]| {
        let map = nv_flip::flip(shown(one), shown(other), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
        nv_flip::FlipPool::from_image(&map).mean()
    };
    let (truth, of_few_paths) = (of_paths(512, 1), of_paths(16, 2));
    let gathered: Vec<Vec3> = pixels.iter().flatten().map(|light| light.irradiance).collect();
    let (found, noise) = (apart(&truth, &gathered), apart(&truth, &of_few_paths));
    // Each path casts two rays from each of its vertices, so these cost more rays than the looks of
    // a pixel.
    assert!(found < noise, "mean ꟻLIP {found}, of sixteen paths a pixel {noise}");
}

/// Truth: Mitsuba 3.9 over the scenes that `selflink export SCENE --to mitsuba` wrote, 4,096 paths
/// a pixel (10,496 of the box and the office), B through the same tone curve. Allowed is what the
/// noise of both adds (2 % of E at nine tenths of the samples, a step that ꟻLIP sees as some 0.02),
/// as much again for the field's error, and for edges, which four samples a pixel draw in steps,
/// and rare bright paths, of which the office's reference shows some dozens.
#[test]
fn pictures_look_like_those_of_another_program() {
    let size = [96, 60];
    for (scene, exposure) in [
        (BuiltinScene::Cornell, 2.0),
        (BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS }, 0.25),
        (BuiltinScene::Office, 0.5),
    ] {
        let (scene, field) = (scene.name(), solved_to(scene.build(), 0.05));
        let lens = Lens::of_pose(&field.0.camera.expect("ours has a view"), size[0] as f32 / size[1] as f32);
        let mut picture = GatheredPicture::new(field.1, lens, size, 0.02, Start::Fine, false);
        finish(&mut picture);
        let layers = picture.layers().expect("a picture");
        let tone = |b: f32| (255.0 * encode_gamma(tone_curve(exposure * b))).round() as u8;
        let ours: Vec<u8> = layers.pixels.iter().flat_map(|pixel| pixel.radiosity.to_array().map(tone)).collect();
        let path = format!("{}/tests/references/{scene}.png", env!("CARGO_MANIFEST_DIR"));
        let truth = image::open(&path).expect("a reference is there").into_rgb8();
        assert_eq!(truth.dimensions(), (size[0], size[1]));
        let [ours, truth] =
            [&ours, truth.as_raw()].map(|pixels| nv_flip::FlipImageRgb8::with_data(size[0], size[1], pixels));
        let map = nv_flip::flip(truth, ours, nv_flip::DEFAULT_PIXELS_PER_DEGREE);
        let apart = nv_flip::FlipPool::from_image(&map).mean();
        println!("{scene}: mean ꟻLIP {apart:.4}");
        assert!(apart < 0.06, "{scene}: mean ꟻLIP {apart}");
    }
}

/// Truth: by hand. One look that by chance finds a thousand times the light of those around it
/// leaves no spot: it brings no more than 16 times theirs, of which some 25 samples take a part.
#[test]
fn a_rare_bright_ray_leaves_no_spot() {
    let (_, field, lens) = cornell();
    let never = CancelToken::new();
    let visible = VisibleSurfaces::look(&field, &lens, SIZE, 1, &never).expect("nobody cancels");
    let mut light = Light::new(&visible);
    light.look(&field, &visible, &Tiles::all(SIZE), &never).expect("nobody cancels");
    let shared = |light: &Light| Filter::PICTURE.share(&visible, light, &never).expect("nobody cancels");
    let plain = shared(&light);
    let middle = (SIZE[1] / 2 * SIZE[0] + SIZE[0] / 2) as usize;
    light.found[middle].sums[1] = 1000.0 * plain[middle].irradiance;
    let spotted = shared(&light);
    let brighter = plain.iter().zip(&spotted).map(|(plain, spotted)| (spotted.irradiance / plain.irradiance).y);
    let most = brighter.filter(|ratio| ratio.is_finite()).fold(0.0, f32::max);
    // A weight of 0.14 in the middle of the first pass's kernel; 40 times without the limit.
    assert!(most > 1.05 && most < 1.0 + 0.14 * 16.0, "{most}");
}

#[test]
fn pictures_are_the_same_for_any_number_of_threads() {
    let (_, field, lens) = cornell();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut picture = picture(&field, lens, 0.1, Start::Coarse);
            finish(&mut picture);
            picture.layers().expect("a picture")
        })
    };
    assert!(with(1) == with(2));
}

#[test]
fn a_picture_is_coarse_first_and_gets_better() {
    let (_, field, lens) = cornell();
    let mut picture = picture(&field, lens, 0.05, Start::Coarse);
    assert!(shown(&picture).is_none());
    picture.advance(&CancelToken::new()).expect("nobody cancels");
    let coarse = (picture.noise().expect("a picture"), shown(&picture).expect("a picture"));
    assert_eq!(coarse.1.len(), (SIZE[0] * SIZE[1]) as usize);
    finish(&mut picture);
    assert!(picture.noise().expect("a picture") <= 0.05 && coarse.0 > 0.05);
    let fine = shown(&picture).expect("a picture");
    let mean = |pixels: &[[u8; 4]]| {
        pixels.iter().flat_map(|pixel| &pixel[..3]).map(|channel| f32::from(*channel)).sum::<f32>()
            / pixels.len() as f32
    };
    // The mean of all is surer than nine tenths of the samples are: brightness does not jump.
    assert!(
        coarse.1 != fine && (mean(&coarse.1) / mean(&fine) - 1.0).abs() < coarse.0,
        "{} {}",
        mean(&coarse.1),
        mean(&fine)
    );
}

#[test]
fn a_cancelled_picture_keeps_what_it_shows() {
    let (_, field, lens) = cornell();
    let mut picture = picture(&field, lens, 0.001, Start::Coarse);
    let cancelled = CancelToken::new();
    cancelled.cancel();
    assert!(picture.advance(&cancelled).is_none());
    assert!(shown(&picture).is_none() && picture.noise().is_none());
    let mut picture = self::picture(&field, lens, 0.001, Start::Coarse);
    picture.advance(&CancelToken::new()).expect("nobody cancels");
    let before = shown(&picture);
    assert!(picture.advance(&cancelled).is_none());
    assert!(before.is_some() && shown(&picture) == before);
}
