//! Selflink: hierarchical radiosity with isotropic clusters, refined from the root's self-link.
//!
//! The method is that of Stamminger, Nitsch, Slusallek and Seidel \[1\], "the paper" wherever the
//! code speaks of sections, figures and tables. A scene of diffuse polygons is solved for its
//! radiosity: how much light leaves each surface once light has been reflected to and fro for ever.
//!
//! # The method on one page
//!
//! All elements of the solution form one tree (\[1\] section 1.2, \[2\]). Its root is a cluster of
//! everything; a cluster holds clusters and *initial patches*, which are the polygons of the scene;
//! a patch holds the four patches into which it was subdivided. A *link* r ← s says that element r
//! receives light of element s. At first there is one link, from the root to itself: everything
//! lights everything, evenly.
//!
//! 1. **Judge.** A link is good enough if the power that it could carry at most, B_s·F·A_r, does
//!    not exceed ε ("BFA", section 2.3, \[3\]); a link whose ends see each other only in part must
//!    stay below a stricter ε_partial. Random rays between the ends find the visibility V, more of
//!    them the more power is at stake (section 2.4). Where nothing is seen, the link goes.
//! 2. **Refine.** A link that is not good enough is replaced by links of the children of its larger
//!    end. A cluster's self-link is replaced by links between all pairs of its children, their own
//!    self-links included. This goes on in waves: the links of a wave are judged in parallel, and
//!    the verdicts applied in order, so that a solve is the same bit for bit for any number of
//!    threads.
//! 3. **Gather.** Light moves once over every link, E_r += B_s·F·V; what a cluster emits has an F·V
//!    of its own, for its lamps may face another way than the rest of it. What a cluster receives
//!    is handed to the patches below it, link by link with each patch's cosine towards the source
//!    (section 3.3, α-links of \[4\]) or evenly afterwards (β-links). Leaves reflect, B = B_e + ρE,
//!    and parents take the mean of their children. Sweeps are repeated until no power is left to
//!    move.
//! 4. **Repeat.** B has grown, so links are judged again; those that fail now are refined. Done
//!    when none fails.
//!
//! A cluster has no normal: to the oracle it is a volume of randomly turned faces, whose cosine is
//! ¼ on average, so a form factor between two clusters carries 1/16 (\[2\]). What a link then
//! carries is found by pairs of points on its ends, or by that same model
//! ([`transport::ClusterModel`]). Parts of faces that lie hidden inside of things are no area
//! ([`geometry::Reachability`]). At any time there is a picture: links that still wait to be judged
//! count as they are, so the first picture, which the root's self-link alone makes, is there at
//! once, and later ones sharpen.
//!
//! # Symbols and units
//!
//! Lengths are metres where powers are to be read in watts. Light has three colours; where one
//! number is needed, the largest counts.
//!
//! | symbol | in code | unit | meaning |
//! | --- | --- | --- | --- |
//! | B | `radiosity` | W/m² | power that leaves a surface, per area; its radiance is L = B/π |
//! | B_e | `emission` | W/m² | what a lamp sends by itself: π times `Ke` of an OBJ file or the emission of glTF |
//! | ρ | `reflectance` | – | share of the light that is reflected, 0 ≤ ρ < 1 |
//! | E | `irradiance` | W/m² | power that reaches a surface, per area; B = B_e + ρE |
//! | A | `area` | m² | area; of a cluster, the sum of its polygons' areas |
//! | F(r←s) | `form_factor` | – | share of r's view that s fills, unoccluded; A_r·F(r←s) = A_s·F(s←r) |
//! | V | `visibility` | 0..1 | share of the rays of a link that came through |
//! | Φ | `emitted_power` | W | Σ A·B_e over the scene |
//! | ε | `epsilon` | W, or a share of Φ | threshold on B_s·F·A_r |
//! | ε_partial | `partial_factor` · ε | W | the same where an end is seen only in part |
//! | f_vis | `visibility_factor` | rays | a link gets f_vis · BFA/ε rays, within bounds |
//!
//! A face has one bright side, the one from which its corners run anticlockwise; its back reflects
//! nothing but stops light all the same ([`geometry::orient`] turns or doubles faces of scenes that
//! are wound otherwise).
//!
//! # Modules
//!
//! Imports run one way, from below to above:
//!
//! | module | what it is |
//! | --- | --- |
//! | [`base`] | long work that can be stopped, numbers for people, random ones, lux, memory |
//! | [`scene`] | polygons, materials, groups; loading OBJ, glTF, PLY and STL, sidecars, our own scenes |
//! | [`geometry`] | rays and the faces that they leave and meet; which sides are bright, which parts light can reach, where walls part surfaces |
//! | [`prepare`] | a scene made ready: light that a person adds, faces turned, a place to look from |
//! | [`hierarchy`] | the tree of elements and the ways to build its clusters |
//! | [`transport`] | links: oracle, refinement, push and pull, light moved over them; what a coarser threshold merges back |
//! | [`gather`] | light at any point over what the links know, with its standard error; the certificate |
//! | [`solve`] | what a solve is at and what comes next, snapshots, timeline, statistics; every parameter ([`solve::PARAMETERS`]) |
//! | [`read`] | values at points, at probes and on a work plane; from W/m² to colours; the link matrix; pictures gathered at their pixels |
//! | [`export`] | the lit mesh as PLY or GLB, links as CSV, pictures in W/m² as EXR, settings as JSON, scenes for other programs |
#![cfg_attr(feature = "gui", doc = "| [`render`] | the wgpu picture of a snapshot, with and without a window |")]
//! | [`measure`] | how far a solution is from the truth: a reference without the solver's code, closed forms, charts, the paper's tables run again, the places where methods of this kind fail |
//! | [`worker`] | a thread that solves while somebody looks |
#![cfg_attr(feature = "gui", doc = "| [`app`] | the window |")]
//!
//! The feature `gui` (on by default) holds what needs a graphics adapter
//! or a window; all else is a library that needs neither:
//!
//! ```
//! use std::sync::Arc;
//!
//! use selflink::base::cancel::CancelToken;
//! use selflink::scene::{Sides, builtin::BuiltinScene};
//! use selflink::solve::{Epsilon, Solver, SolverParams};
//!
//! let scene = BuiltinScene::Cornell.build();
//! let (scene, occluders) = selflink::geometry::orient::apply(scene, Sides::Front);
//! let params = SolverParams { epsilon: Epsilon::Relative(1e-2), ..SolverParams::default() };
//! let mut solver = Solver::new(Arc::new(scene), Arc::new(occluders), params, 1)?;
//! solver.run(&CancelToken::new());
//! let snapshot = solver.snapshot();
//! assert!(snapshot.stats.converged);
//! println!("{} links light {} patches", snapshot.stats.links, snapshot.stats.patches);
//! # Ok::<(), selflink::solve::SolverError>(())
//! ```
//!
//! # Bibliography
//!
//! 1. M. Stamminger, W. Nitsch, Ph. Slusallek, H.-P. Seidel. *Isotropic Clustering for Hierarchical
//!    Radiosity – Implementation and Experiences.* University of Erlangen.
//! 2. F. X. Sillion. *A unified hierarchical algorithm for global illumination with scattering
//!    volumes and object clusters.* IEEE Transactions on Visualization and Computer Graphics, pp.
//!    240–254, September 1995.
//! 3. D. Lischinski, B. Smits, D. P. Greenberg. *Bounds and error estimates for radiosity.*
//!    SIGGRAPH 1994, pp. 75–84.
//! 4. B. Smits, J. Arvo, D. Greenberg. *A clustering algorithm for radiosity in complex
//!    environments.* SIGGRAPH 1994, pp. 435–442.
//! 5. F. X. Sillion. *Clustering and volume scattering for hierarchical radiosity computations.*
//!    Fifth Eurographics Workshop on Rendering, pp. 105–117, June 1994.
//! 6. F. Sillion, G. Drettakis. *Feature-based control of visibility error: a multi-resolution
//!    clustering algorithm for global illumination.* SIGGRAPH 1995, pp. 145–152.
//! 7. F. X. Sillion, G. Drettakis, C. Soler. *A clustering algorithm for radiance calculation in
//!    general environments.* Sixth Eurographics Workshop on Rendering, pp. 159–171, June 1995.
//! 8. N. Holzschuch, F. Sillion, G. Drettakis. *An efficient progressive refinement strategy for
//!    hierarchical radiosity.* Fifth Eurographics Workshop on Rendering, pp. 343–357, June 1994.
//! 9. H. E. Rushmeier, K. E. Torrance. *The zonal method for calculating light intensities in the
//!    presence of a participating medium.* SIGGRAPH 1987, pp. 293–302.
//! 10. D. Lischinski, F. Tampieri, D. P. Greenberg. *Combining hierarchical radiosity and
//!     discontinuity meshing.* SIGGRAPH 1993, pp. 199–208.

#[cfg(feature = "gui")]
pub mod app;
pub mod base;
pub mod export;
pub mod gather;
pub mod geometry;
pub mod hierarchy;
pub mod measure;
pub mod prepare;
pub mod read;
#[cfg(feature = "gui")]
pub mod render;
pub mod scene;
pub mod solve;
pub mod transport;
pub mod worker;
