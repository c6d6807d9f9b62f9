//! `selflink render`: a picture of the solution, drawn without a window, as PNG or, in W/m², as
//! EXR.

use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, anyhow, bail};
use clap::{ArgAction, ArgMatches, Command};
use glam::{DVec3, Vec2};
use image::RgbaImage;
use selflink::export::{PictureFormat, exr};
use selflink::read::daylight_factor::open_ground;
use selflink::read::picture::GatheredPicture;
use selflink::render::{
    Camera, ChosenLinks, ClusterView, Display, Exposure, Frame, IsolinesWanted, LightMeter, LinkFilter, LinkStyle,
    MAX_SIZE, Marks, Offscreen, Overlay, ReadingSettings, Show, annotate, by_clusters, developed, pick, picked_marks,
};
use selflink::scene::{CameraPose, FiledCamera, Scene};
use selflink::transport::{LinkView, SolutionView};

use super::gathered::{PictureOf, gather};
use super::job::{Order, Solution};
use super::options::{self, coordinates, numbers, path, path_arg, value_arg};
use super::output::{OutputFile, say};
use super::{clusters, reading};

/// Pixels of a picture that nothing is said about.
const USUAL_SIZE: [u32; 2] = [1280, 800];
/// Horizontal field of view where neither scene nor person names one, degrees.
const USUAL_HFOV: f32 = 60.0;

/// The command's arguments.
pub fn command() -> Command {
    let command = Command::new("render").about("Solve a scene and draw it to a PNG or EXR file, without a window");
    reading::with_options(options::solving(command))
        .arg(
            path_arg("out", "FILE.png|exr")
                .required(true)
                .help("The picture as it is shown (PNG), or radiosities in W/m², unexposed and without overlays (EXR)"),
        )
        .arg(value_arg("size", "WxH").help("Pixels [default: 1280x800]"))
        .arg(
            value_arg("camera", "EX,EY,EZ:TX,TY,TZ|NAME")
                .allow_hyphen_values(true)
                .help("Where the eye is and the point it looks at, or the name of one of the file's cameras [default: as the scene says, from inside its largest room, or all of it]"),
        )
        .arg(
            value_arg("exposure", "auto|STOPS")
                .allow_hyphen_values(true)
                .help("Exposure: automatic, or in stops, 0 showing 1 W/m² as 1 [default: auto]"),
        )
        .arg(
            value_arg("overlay", "elements|clusters:LEVEL|links:X,Y|level-links:LEVEL")
                .action(ArgAction::Append)
                .help("Draw over the picture: outlines of the patches, boxes of the clusters of a level (0 is the root), the links of the surface at a pixel, or those of all receivers at a level below the root; the strongest 200. May be given several times"),
        )
        .arg(
            value_arg("explode", "0 to 1")
                .allow_hyphen_values(true)
                .help("Pull the clusters apart of the level that --show or else --overlay names; at 1 they lie twice as far from the middle [default: 0]"),
        )
        .arg(
            value_arg("picture", "mesh|gathered")
                .value_parser(["mesh", "gathered"])
                .help("Light interpolated between the mesh's vertices, or gathered at every pixel until its noise is below --error; clusters show the mesh [default: gathered]"),
        )
}

/// How a picture is to be drawn.
pub struct View {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Eye and target, in the coordinates of the scene's file.
    pub camera: Option<[DVec3; 2]>,
    /// Name of one of the file's cameras, perhaps, where no points are given.
    pub named_camera: Option<String>,
    /// The whole view, where neither of these is given.
    pub pose: Option<FiledCamera>,
    /// How bright the picture is made.
    pub exposure: Exposure,
    /// Lines drawn over the picture.
    pub overlay: Overlay,
    /// Clusters as colours, or pulled apart.
    pub clusters: Option<ClusterView>,
    /// Quantity read off the surfaces.
    pub reading: ReadingSettings,
    /// Whether a legend tells what false colours mean.
    pub has_legend: bool,
    /// Of what.
    pub picture: PictureOf,
    /// The links over it.
    pub links: Option<LinksOf>,
}

/// Whose links are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinksOf {
    /// Links of the surface at a pixel.
    Pixel([f32; 2]),
    /// Links of all receivers at a level below the root.
    Level(u16),
}

impl Default for View {
    fn default() -> Self {
        Self {
            size: USUAL_SIZE,
            camera: None,
            named_camera: None,
            pose: None,
            exposure: Exposure::default(),
            overlay: Overlay::default(),
            clusters: None,
            reading: ReadingSettings::default(),
            has_legend: true,
            picture: PictureOf::default(),
            links: None,
        }
    }
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> anyhow::Result<()> {
    let order = Order::from_matches(matches)?;
    let mut view = View { pose: order.settings.camera, ..view(matches)? };
    let path = path(matches, "out").unwrap_or_default();
    let format = PictureFormat::of(&path)?;
    if format == PictureFormat::Exr && (view.overlay != Overlay::default() || view.links.is_some()) {
        bail!(
            "--overlay draws over pictures as they are shown (PNG), not over radiosities (EXR): leave one of them out"
        );
    }
    let file = OutputFile::new(&path, &order.inputs())?;
    let job = order.load()?;
    if let Some(name) = &view.named_camera {
        view.pose = Some(camera_named(&job.scene, name)?);
    }
    let open_ground = open_ground(&job.scene);
    if let (Show::DaylightFactor, Err(missing)) = (view.reading.show, open_ground) {
        bail!("--show daylight-factor: {missing}");
    }
    let wants_lines = view.overlay != Overlay::default() || view.links.is_some();
    // Before the long work, so that a missing adapter is reported soon.
    let early = (view.picture == PictureOf::Mesh || wants_lines).then(Offscreen::new).transpose()?;
    let deadline = job.limit.map(|limit| Instant::now() + limit);
    let mut solution = job.solve()?;
    let gathered = match view.picture {
        PictureOf::Mesh => None,
        PictureOf::Gathered => {
            let has_lines = view.reading.isolines != IsolinesWanted::None;
            gather(&job, &solution, &camera(&job.scene, &view), view.size, has_lines, deadline)?
        }
    };
    if gathered.is_none() && matches.get_one::<String>("picture").is_some_and(|of| of == "gathered") {
        eprintln!("warning: {NO_FIELD}, so the picture is of the mesh.");
    }
    let mut offscreen =
        if gathered.is_some() && !wants_lines { None } else { Some(early.map_or_else(Offscreen::new, Ok)?) };
    match (format, &gathered, &mut offscreen) {
        (PictureFormat::Png, Some(picture), None) => file.write_png(&show(picture, &job.scene, &solution, &view)?)?,
        (PictureFormat::Png, picture, Some(offscreen)) => {
            file.write_png(&draw(offscreen, &job.scene, &mut solution, &view, picture.as_ref())?)?;
        }
        (PictureFormat::Exr, Some(picture), _) => {
            let layers = picture.layers().context("the picture has no pixels")?;
            file.write(|writer| exr::write_layers(writer, &layers))?;
        }
        (PictureFormat::Exr, None, Some(offscreen)) => {
            let picture = offscreen.radiosities(&solution.snapshot, &camera(&job.scene, &view), view.size)?;
            file.write(|writer| exr::write(writer, &picture))?;
        }
        (_, None, None) => unreachable!("what is not gathered is drawn"),
    }
    let [width, height] = view.size;
    let mut how = Vec::new();
    if let Some(noise) = gathered.as_ref().and_then(GatheredPicture::noise) {
        how.push(format!("gathered, noise {:.1} %", 100.0 * noise));
    }
    how.extend(offscreen.map(|offscreen| format!("drawn by {}", offscreen.adapter())));
    say(&format!("{}: {width} × {height} pixels, {}\n", file.path().display(), how.join(", ")))
}

/// Why there is no field.
const NO_FIELD: &str = "light can be gathered at pixels only over a solve to an error (--error) that has ended";

/// A gathered picture as it is shown, without lines over it.
fn show(picture: &GatheredPicture, scene: &Scene, solution: &Solution, view: &View) -> anyhow::Result<RgbaImage> {
    let exposure = metered_exposure(scene, solution, view);
    let reading = view.reading.reading(&solution.snapshot, open_ground(scene).ok());
    let pixels = developed(picture, exposure, reading.as_ref()).context("the picture has no pixels")?;
    let [width, height] = pixels.size;
    let mut picture = RgbaImage::from_raw(width, height, pixels.pixels.into_flattened()).context("too few pixels")?;
    if let Some(reading) = &reading {
        annotate(&mut picture, reading, &pixels.labels, view.has_legend)?;
    }
    Ok(picture)
}

/// The factor on radiosities, m²/W, by which a view is shown: metered on what is seen, as in the
/// window.
fn metered_exposure(scene: &Scene, solution: &Solution, view: &View) -> f32 {
    let [width, height] = view.size.map(|pixels| pixels as f32);
    let (snapshot, occluders) = (&solution.snapshot, solution.solver.link_solution().occluders());
    let meter = LightMeter::new(snapshot, scene);
    let metered = meter.exposure(snapshot, occluders, &camera(scene, view), width / height).factor;
    view.exposure.factor(metered)
}

/// Draws a solution, or lines over a gathered picture of it.
pub fn draw(
    offscreen: &mut Offscreen,
    scene: &Scene,
    solution: &mut Solution,
    view: &View,
    gathered: Option<&GatheredPicture>,
) -> anyhow::Result<RgbaImage> {
    let camera = camera(scene, view);
    let deepest = solution.snapshot.clusters.iter().map(|cluster| cluster.level).max().unwrap_or(0);
    let levels = view.overlay.clusters.into_iter().chain(view.clusters.map(|clusters| clusters.level));
    if let Some(level) = levels.max().filter(|level| *level > deepest) {
        eprintln!("note: there are no clusters of level {level} to be drawn, the deepest have level {deepest}.");
    }
    let mut overlay = view.overlay.clone();
    match view.links {
        Some(LinksOf::Pixel(pixel)) => overlay.marks = links_at(solution, &camera, pixel, view.size),
        Some(LinksOf::Level(level)) => overlay.marks = links_of_level(solution, level),
        None => {}
    }
    let by_clusters = view.clusters.and_then(|clusters| {
        solution_view(solution)?;
        by_clusters(&solution.snapshot, ClusterView { level: clusters.level.min(deepest), ..clusters })
    });
    let snapshot = by_clusters.as_ref().unwrap_or(&solution.snapshot);
    let reading = view.reading.reading(&solution.snapshot, open_ground(scene).ok());
    let as_colours = view.clusters.is_some_and(|clusters| clusters.coloured);
    let exposure = metered_exposure(scene, solution, view);
    let display = Display { exposure, as_colours, reading };
    let gathered = gathered.and_then(|picture| developed(picture, exposure, reading.as_ref())).map(Arc::new);
    let frame = Frame {
        snapshot,
        outside: scene.outside(),
        camera: &camera,
        display: &display,
        gathered: gathered.as_ref(),
        overlay: &overlay,
        size: view.size,
    };
    let mut picture = offscreen.picture_over(&frame)?;
    if let Some(reading) = &reading {
        let labels = gathered.as_ref().map_or(&[][..], |pixels| &pixels.labels);
        annotate(&mut picture, reading, labels, view.has_legend && !as_colours)?;
    }
    Ok(picture)
}

fn camera(scene: &Scene, view: &View) -> Camera {
    let [width, height] = view.size.map(|pixels| pixels as f32);
    let aspect = width / height;
    let given = view.camera.map(|[eye, target]| CameraPose {
        eye: scene.from_file(eye),
        target: scene.from_file(target),
        up: scene.camera.map_or_else(|| scene.up_axis(), |camera| camera.up),
        hfov_deg: scene.camera.map_or(USUAL_HFOV, |camera| camera.hfov_deg),
    });
    given
        .or_else(|| view.pose.map(|pose| pose.in_scene(scene)))
        .map_or_else(|| Camera::of_scene(scene, aspect), |pose| Camera::from_pose(&pose, aspect, scene.bounds()))
}

/// The view of one of the file's cameras.
fn camera_named(scene: &Scene, name: &str) -> anyhow::Result<FiledCamera> {
    if let Some(camera) = scene.cameras.iter().find(|camera| camera.name == name) {
        return Ok(camera.pose.in_file(scene));
    }
    let names: Vec<String> = scene.cameras.iter().map(|camera| format!("`{}`", camera.name)).collect();
    let there = if names.is_empty() { "it has none".to_owned() } else { names.join(", ") };
    bail!(
        "--camera must be ex,ey,ez:tx,ty,tz, eye and target away from each other, or one of the file's cameras: {there} (it is `{name}`)"
    )
}

/// The links of the surface at a pixel.
fn links_at(solution: &mut Solution, camera: &Camera, [x, y]: [f32; 2], [width, height]: [u32; 2]) -> Marks {
    let (width, height) = (width as f32, height as f32);
    let ndc = Vec2::new(2.0 * (x + 0.5) / width - 1.0, 1.0 - 2.0 * (y + 0.5) / height);
    let (origin, direction) = camera.ray(ndc, width / height);
    match pick(&solution.snapshot.mesh, origin, direction) {
        Some(picked) => {
            let element = solution.snapshot.mesh.leaves[picked.leaf as usize].element;
            let Some(solution_view) = solution_view(solution) else { return Marks::default() };
            let style = LinkStyle { ends: false, ..LinkStyle::default() };
            let mut lines = chosen(&solution_view, solution_view.incoming(element)).lines(&solution_view, style);
            lines.extend(picked_marks(&solution_view, element));
            lines.into()
        }
        None => {
            eprintln!("warning: no surface is to be seen at pixel {x},{y}, so no links are drawn.");
            Marks::default()
        }
    }
}

/// The links of all receivers at a level.
fn links_of_level(solution: &mut Solution, level: u16) -> Marks {
    let Some(solution_view) = solution_view(solution) else { return Marks::default() };
    if level > solution_view.deepest() {
        eprintln!(
            "note: there are no elements at level {level} to be linked, the deepest have level {}.",
            solution_view.deepest()
        );
    }
    chosen(&solution_view, solution_view.links_at_depth(level)).lines(&solution_view, LinkStyle::default()).into()
}

/// The strongest links, and a word about the rest.
fn chosen(solution_view: &SolutionView, links: impl IntoIterator<Item = LinkView>) -> ChosenLinks {
    let chosen = ChosenLinks::new(links, &LinkFilter::default(), solution_view.epsilon_watts());
    eprintln!("note: {}.", chosen.to_string().to_lowercase());
    chosen
}

/// The solution's elements and links.
fn solution_view(solution: &mut Solution) -> Option<Arc<SolutionView>> {
    solution.solver.show_solution_view(true);
    solution.snapshot = solution.solver.snapshot();
    solution.snapshot.solution_view.clone()
}

fn view(matches: &ArgMatches) -> anyhow::Result<View> {
    let text = |name: &str| matches.get_one::<String>(name).map(String::as_str);
    let size = text("size").map_or(Ok(USUAL_SIZE), size)?;
    let camera = text("camera").and_then(eye_and_target);
    let named_camera = text("camera").filter(|_| camera.is_none()).map(str::to_owned);
    let exposure = text("exposure").map_or(Ok(Exposure::default()), exposure)?;
    let (reading, has_legend) = (reading::settings(matches)?, !matches.get_flag("no-legend"));
    let mut view = View { size, camera, named_camera, exposure, reading, has_legend, ..View::default() };
    for overlay in matches.get_many::<String>("overlay").unwrap_or_default() {
        add_overlay(&mut view, overlay)?;
    }
    view.clusters = clusters::view(text("show"), text("explode"), view.overlay.clusters)?;
    view.picture = picture_of(text("picture"), view.clusters.is_some())?;
    if view.links.is_some() && view.clusters.is_some_and(|clusters| clusters.explode > 0.0) {
        bail!("--explode moves surfaces away from their links: leave out --overlay links or --explode");
    }
    Ok(view)
}

/// Clusters are drawn as parts of the mesh.
fn picture_of(asked: Option<&str>, shows_clusters: bool) -> anyhow::Result<PictureOf> {
    match (asked, shows_clusters) {
        (Some("gathered"), true) => {
            bail!("clusters show the mesh: leave out --picture gathered, or --show clusters and --explode")
        }
        (Some("mesh"), _) | (None, true) => Ok(PictureOf::Mesh),
        _ => Ok(PictureOf::Gathered),
    }
}

/// Width and height, pixels.
pub fn size(text: &str) -> anyhow::Result<[u32; 2]> {
    let parsed =
        text.split_once(['x', '×']).and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    match parsed {
        Some([width, height]) if (1..=MAX_SIZE).contains(&width) && (1..=MAX_SIZE).contains(&height) => {
            Ok([width, height])
        }
        _ => bail!("--size must be WIDTHxHEIGHT with 1 to {MAX_SIZE} pixels each way (it is `{text}`)"),
    }
}

fn eye_and_target(text: &str) -> Option<[DVec3; 2]> {
    let (eye, target) = text.split_once(':')?;
    let [eye, target] = [coordinates::<3>(eye, ',')?, coordinates::<3>(target, ',')?].map(DVec3::from);
    (eye != target).then_some([eye, target])
}

fn exposure(text: &str) -> anyhow::Result<Exposure> {
    if text == "auto" {
        return Ok(Exposure::default());
    }
    match text.parse::<f32>() {
        // Beyond, the factor is no f32 any more.
        Ok(stops) if stops.abs() <= 100.0 => Ok(Exposure::Manual { stops }),
        _ => bail!("--exposure must be auto or a number of stops between -100 and 100 (it is `{text}`)"),
    }
}

fn add_overlay(view: &mut View, text: &str) -> anyhow::Result<()> {
    let unknown =
        || anyhow!("--overlay must be elements, clusters:LEVEL, links:X,Y or level-links:LEVEL (it is `{text}`)");
    match text.split_once(':') {
        None if text == "elements" => view.overlay.elements = true,
        Some(("clusters", level)) => view.overlay.clusters = Some(level.parse().map_err(|_| unknown())?),
        Some(("links", pixel)) => {
            let pixel = numbers::<2>(pixel, ',').ok_or_else(unknown)?;
            let [width, height] = view.size.map(|pixels| pixels as f32);
            if !((0.0..width).contains(&pixel[0]) && (0.0..height).contains(&pixel[1])) {
                bail!("--overlay {text} lies outside the picture of {width}x{height} pixels");
            }
            view.links = Some(LinksOf::Pixel(pixel));
        }
        Some(("level-links", level)) => view.links = Some(LinksOf::Level(level.parse().map_err(|_| unknown())?)),
        _ => return Err(unknown()),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn sizes_and_cameras_are_read() {
        assert_eq!(size("640x480").expect("good"), [640, 480]);
        for text in ["", "640", "0x480", "640x", "-1x5", "1e3x5", "640x99999"] {
            assert!(size(text).is_err(), "{text}");
        }
        let camera = eye_and_target("-1,2,3:0,0,0.5").expect("good");
        assert_eq!(camera, [DVec3::new(-1.0, 2.0, 3.0), DVec3::new(0.0, 0.0, 0.5)]);
        for text in ["", "1,2,3", "1,2:3,4", "1,2,3:1,2,3", "1,2,NaN:0,0,0"] {
            assert!(eye_and_target(text).is_none(), "{text}");
        }
    }

    #[test]
    fn cameras_of_the_file_go_by_their_names() {
        let mut scene = Scene::new("house");
        let pose = CameraPose { eye: Vec3::new(1.0, 1.6, 2.0), target: Vec3::ZERO, up: Vec3::Y, hfov_deg: 60.0 };
        scene.cameras.push(selflink::scene::NamedCamera { name: "door: left".to_owned(), pose });
        assert_eq!(camera_named(&scene, "door: left").expect("it is there").in_scene(&scene), pose);
        let said = camera_named(&scene, "window").expect_err("it is not there").to_string();
        assert!(said.contains("`door: left` (it is `window`)"), "{said}");
    }

    #[test]
    fn overlays_are_read_together() {
        let mut view = View::default();
        for text in ["elements", "clusters:3", "links:10,20"] {
            add_overlay(&mut view, text).expect("good");
        }
        assert!(view.overlay.elements);
        assert_eq!((view.overlay.clusters, view.links), (Some(3), Some(LinksOf::Pixel([10.0, 20.0]))));
        add_overlay(&mut view, "level-links:4").expect("good");
        assert_eq!(view.links, Some(LinksOf::Level(4)));
        for text in ["", "boxes", "clusters", "clusters:x", "links:1", "links:5000,1", "links:-1,1", "level-links:x"] {
            assert!(add_overlay(&mut view, text).is_err(), "{text}");
        }
    }
}
