//! Textures: pictures decoded once, where a material's lie on its faces, and their colours in
//! linear light.
//!
//! Rows run downwards and v with them, as in glTF; readers of other formats turn v round.

mod basis;
pub(super) mod decode;
pub(super) mod mean;

use std::sync::{Arc, LazyLock, OnceLock};

use glam::{Affine2, Vec2, Vec3, Vec4};

/// Linear values of the 256 steps of sRGB (IEC 61966-2-1).
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|value| {
        let value = value as f64 / 255.0;
        (if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }) as f32
    })
});

/// The linear value of a step of sRGB.
pub(super) fn linear_step(step: u8) -> f32 {
    LINEAR[usize::from(step)]
}

/// A decoded picture: sRGB colours and linear alpha, as most files hold them.
#[derive(Clone)]
pub struct Texture {
    width: u32,
    height: u32,
    texels: Vec<[u8; 4]>,
    /// Half as large, for what lies far away; made when it is asked for.
    half: OnceLock<Box<Texture>>,
}

impl PartialEq for Texture {
    fn eq(&self, other: &Self) -> bool {
        (self.width, self.height, &self.texels) == (other.width, other.height, &other.texels)
    }
}

impl std::fmt::Debug for Texture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Texture({} × {})", self.width, self.height)
    }
}

impl Texture {
    /// A picture of texels row by row from the top.
    ///
    /// # Panics
    /// The number of texels must be width × height, and not 0.
    pub fn new(width: u32, height: u32, texels: Vec<[u8; 4]>) -> Self {
        assert!(width as usize * height as usize == texels.len() && !texels.is_empty(), "texels fill the picture");
        Self { width, height, texels, half: OnceLock::new() }
    }

    /// Width and height, texels.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Texels row by row from the top: sRGB and linear alpha, as a graphics adapter takes them.
    pub fn texels(&self) -> &[[u8; 4]] {
        &self.texels
    }

    /// A texel in linear light, with its alpha.
    pub fn linear(&self, x: u32, y: u32) -> Vec4 {
        let [r, g, b, a] = self.texels[(y * self.width + x) as usize];
        let colour = [r, g, b].map(|value| LINEAR[usize::from(value)]);
        Vec3::from_array(colour).extend(f32::from(a) / 255.0)
    }

    /// White with the picture's values as alpha: those of its own alpha where it has any, else its
    /// brightness, step by step as it is stored.
    pub(super) fn as_opacity(&self) -> Self {
        let has_alpha = self.texels.iter().any(|texel| texel[3] != u8::MAX);
        let value = |&[r, g, b, a]: &[u8; 4]| {
            let luma = (299 * u32::from(r) + 587 * u32::from(g) + 114 * u32::from(b) + 500) / 1000;
            [u8::MAX, u8::MAX, u8::MAX, if has_alpha { a } else { luma as u8 }]
        };
        Self::new(self.width, self.height, self.texels.iter().map(value).collect())
    }

    /// The texture in a size whose texels are about as large as so many of its own.
    fn shrunk(&self, texels: f32) -> &Self {
        if texels < 1.5 || self.texels.len() == 1 {
            return self;
        }
        self.half.get_or_init(|| Box::new(self.halved())).shrunk(0.5 * texels)
    }

    /// Half as large, means taken in linear light and weighted by alpha; a side of one texel stays.
    fn halved(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let texel = |index: u32| {
            let (x, y) = (2 * (index % width), 2 * (index / width));
            let (right, below) = ((x + 1).min(self.width - 1), (y + 1).min(self.height - 1));
            let four = [(x, y), (right, y), (x, below), (right, below)].map(|(x, y)| self.linear(x, y));
            let alpha: f32 = four.iter().map(|texel| texel.w).sum();
            let weight = |texel: &Vec4| if alpha > 0.0 { texel.w / alpha } else { 0.25 };
            let colour: Vec3 = four.iter().map(|texel| weight(texel) * texel.truncate()).sum();
            let [r, g, b] = colour.to_array().map(srgb_step);
            [r, g, b, (0.25 * alpha * 255.0).round() as u8]
        };
        Self::new(width, height, (0..width * height).map(texel).collect())
    }
}

/// The step of sRGB that is nearest to a linear value.
fn srgb_step(linear: f32) -> u8 {
    let above = LINEAR.partition_point(|step| *step < linear).min(255);
    let below = above.saturating_sub(1);
    if linear - LINEAR[below] < LINEAR[above] - linear { below as u8 } else { above as u8 }
}

/// Continuation of a texture beyond its rim.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The texture again.
    #[default]
    Repeat,
    /// The texture mirrored, then again.
    Mirror,
    /// The texels of its rim.
    Clamp,
}

impl Wrap {
    /// The texel of a row (or column) of `count` at a whole position, which may lie beyond either
    /// end.
    fn texel(self, at: i64, count: u32) -> u32 {
        let count = i64::from(count);
        let inside = match self {
            Self::Repeat => at.rem_euclid(count),
            Self::Clamp => at.clamp(0, count - 1),
            Self::Mirror => {
                let at = at.rem_euclid(2 * count);
                if at < count { at } else { 2 * count - 1 - at }
            }
        };
        inside as u32
    }
}

/// A texture as a material lays it on its faces.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureMap {
    /// The picture; materials share it.
    pub texture: Arc<Texture>,
    /// From the faces' texture coordinates to the picture's, whose sides are 1 long
    /// (KHR_texture_transform).
    pub transform: Affine2,
    /// Beyond the sides in u and in v.
    pub wrap: [Wrap; 2],
}

impl TextureMap {
    /// Linear colour and alpha at a face's texture coordinates, interpolated between four texels
    /// that are as large as so many of the picture's.
    pub fn sample(&self, uv: Vec2, size: f32) -> Vec4 {
        let texture = self.texture.shrunk(size);
        let [width, height] = texture.size();
        let at = self.transform.transform_point2(uv) * Vec2::new(width as f32, height as f32) - 0.5;
        let at = if at.is_finite() { at } else { Vec2::ZERO };
        let (low, part) = (at.floor(), at - at.floor());
        let texel = |right: i64, below: i64| {
            let x = self.wrap[0].texel(low.x as i64 + right, width);
            let y = self.wrap[1].texel(low.y as i64 + below, height);
            texture.linear(x, y)
        };
        let (top, bottom) = (texel(0, 0).lerp(texel(1, 0), part.x), texel(0, 1).lerp(texel(1, 1), part.x));
        top.lerp(bottom, part.y)
    }

    /// Texels that a unit square of texture coordinates covers.
    pub(super) fn texels(&self) -> f32 {
        let [width, height] = self.texture.size().map(|side| side as f32);
        width * height * self.transform.matrix2.determinant().abs()
    }
}

/// Meaning of alpha in a material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Opacity {
    /// Nothing.
    #[default]
    Opaque,
    /// A hole where it is below this.
    Mask(f32),
    /// How much of what lies behind is hidden.
    Blend,
}

/// Alpha below which a picture shows a hole where no cutoff is named: faces count as opaque or not
/// at all, and so do their parts.
const HALF: f32 = 0.5;

/// Interpolated values may be off by so much.
const ROUNDING: f32 = 1e-5;

/// Textures of a material, which a picture needs beside its means, and the meaning of their alpha.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialTextures {
    /// Reflectance is this times [`reflectance_factor`](Self::reflectance_factor).
    pub reflectance: Option<TextureMap>,
    /// Of the file, per colour.
    pub reflectance_factor: Vec3,
    /// Emission is this times [`emission_factor`](Self::emission_factor).
    pub emission: Option<TextureMap>,
    /// Of the file, W/m² per colour.
    pub emission_factor: Vec3,
    /// Of the file; alpha is this times the first texture's and that of a face's corners, as far as
    /// it has a meaning, and that of [`opacity_map`](Self::opacity_map).
    pub alpha_factor: f32,
    /// Meaning of the first texture's alpha and of that of corners.
    pub opacity: Opacity,
    /// Opacity in a texture of its own (`map_d` of OBJ files).
    pub opacity_map: Option<TextureMap>,
}

impl MaterialTextures {
    /// Whether there is a hole where the corners of a face have this alpha in between them, the
    /// first texture has that, and the opacity's that; each is 1 where it is absent.
    pub(super) fn is_hole(&self, of_corners: f32, of_colour: f32, of_opacity: f32) -> bool {
        let (alpha, least) = match self.opacity {
            Opacity::Opaque if self.opacity_map.is_none() => return false,
            Opacity::Opaque => (self.alpha_factor, HALF),
            Opacity::Mask(cutoff) => (self.alpha_factor * of_corners * of_colour, cutoff),
            Opacity::Blend => (self.alpha_factor * of_corners * of_colour, HALF),
        };
        alpha * of_opacity < least - ROUNDING
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: half white and half black is linear 0.5 (sRGB 188, not 128), and a clear texel does
    /// not count.
    #[test]
    fn halves_are_linear_and_weighted_by_alpha() {
        let texels = vec![[255, 255, 255, 255], [0, 0, 0, 255], [9, 99, 200, 0], [70, 1, 2, 0]];
        let half = Texture::new(2, 2, texels).halved();
        assert_eq!((half.size(), half.texels()), ([1, 1], &[[188, 188, 188, 128]][..]));
    }

    /// Truth: the definitions of the three ways (glTF 2.0, section 3.8.4.5).
    #[test]
    fn beyond_the_rim_the_texture_goes_on() {
        let texels = |wrap: Wrap| (-3..6).map(|at| wrap.texel(at, 3)).collect::<Vec<_>>();
        assert_eq!(texels(Wrap::Repeat), [0, 1, 2, 0, 1, 2, 0, 1, 2]);
        assert_eq!(texels(Wrap::Clamp), [0, 0, 0, 0, 1, 2, 2, 2, 2]);
        assert_eq!(texels(Wrap::Mirror), [2, 1, 0, 0, 1, 2, 2, 1, 0]);
    }

    /// Truth: texels' centres give their own values, and halfway between two is their mean in
    /// linear light.
    #[test]
    fn samples_lie_between_texels() {
        let texture = Arc::new(Texture::new(2, 1, vec![[255, 255, 255, 255], [0, 0, 0, 255]]));
        let map = TextureMap { texture, transform: Affine2::IDENTITY, wrap: [Wrap::Clamp; 2] };
        let red = |u: f32| map.sample(Vec2::new(u, 0.3), 1.0).x;
        assert_eq!([red(0.25), red(0.5), red(0.75), red(f32::NAN)], [1.0, 0.5, 0.0, 1.0]);
    }
}
