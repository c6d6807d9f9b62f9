//! The window, driven headless by accessible names as a person drives it.
//!
//! Truth: what the worker says that it took up, and pictures that differ where they must. Needs a
//! wgpu adapter; software Vulkan serves.
#![cfg(feature = "gui")]

mod camera;
mod clusters;
mod compare;
mod craft;
mod daylight;
mod gallery;
mod gathered;
mod inspector;
mod light;
mod live;
mod luminaires;
mod matrix;
mod panels;
mod readings;
mod selection;
mod sizes;
mod status;
mod strain;
mod support;
mod take_along;
mod timeline;
#[path = "../support/waiting.rs"]
mod waiting;
mod watching;
