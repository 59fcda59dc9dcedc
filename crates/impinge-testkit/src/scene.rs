//! Plain data that generators return and oracles accept.

/// Indexed triangle mesh: positions, and three indices into them for each face.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Positions in the mesh's own frame.
    pub vertices: Vec<[f64; 3]>,
    /// Corners of each triangle, as indices into `vertices`.
    pub faces: Vec<[u32; 3]>,
}

/// Affine map x ↦ `linear`·x + `translation`, whose entries are exact real numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// 3x3 matrix by rows, for column vectors.
    pub linear: [[f64; 3]; 3],
    /// Image of the origin.
    pub translation: [f64; 3],
}

/// Borrowed mesh at a pose, as the oracles accept it.
#[derive(Clone, Copy, Debug)]
pub struct Posed<'a> {
    /// Positions in the local frame.
    pub vertices: &'a [[f64; 3]],
    /// Corners of each triangle, as indices into `vertices`.
    pub faces: &'a [[u32; 3]],
    /// Map from the local frame to the world.
    pub world_from_local: Affine,
}

impl Mesh {
    /// Returns this mesh at a pose.
    pub fn at(&self, world_from_local: Affine) -> Posed<'_> {
        Posed { vertices: &self.vertices, faces: &self.faces, world_from_local }
    }

    /// Returns the mesh with every coordinate multiplied by `factor` and rounded once.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.vertices.iter_mut().flatten().for_each(|x| *x *= factor);
        self
    }

    /// Returns the mesh with every coordinate rounded to the nearest f32.
    pub fn rounded_to_f32(mut self) -> Self {
        self.vertices.iter_mut().flatten().for_each(|x| *x = f64::from(*x as f32));
        self
    }

    /// Returns the mesh followed by `other`, whose faces keep their order.
    pub fn joined(mut self, other: &Mesh) -> Self {
        let offset = self.vertices.len() as u32;
        self.vertices.extend_from_slice(&other.vertices);
        self.faces.extend(other.faces.iter().map(|face| face.map(|i| i + offset)));
        self
    }

    /// Returns the 64-bit FNV-1a hash of the little-endian bytes of all positions, followed by all
    /// indices.
    pub fn fingerprint(&self) -> u64 {
        let positions = self.vertices.iter().flatten().flat_map(|x| x.to_le_bytes());
        let indices = self.faces.iter().flatten().flat_map(|i| i.to_le_bytes());
        positions
            .chain(indices)
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
    }
}

impl Affine {
    /// Identity map.
    pub const IDENTITY: Self = Self::translation([0.0; 3]);

    /// Returns the map x ↦ x + `offset`.
    pub const fn translation(offset: [f64; 3]) -> Self {
        Self::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], offset)
    }

    /// Returns the map x ↦ `linear`·x + `translation`.
    pub const fn new(linear: [[f64; 3]; 3], translation: [f64; 3]) -> Self {
        Self { linear, translation }
    }

    /// Returns the image of `point` as `((r0*x + r1*y) + r2*z) + t`, each operation rounded to f64
    /// and none fused.
    pub fn apply_rounded(&self, point: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|k| {
            let [r0, r1, r2] = self.linear[k];
            r0 * point[0] + r1 * point[1] + r2 * point[2] + self.translation[k]
        })
    }
}

impl Posed<'_> {
    /// Returns the corners of one face, in the local frame.
    ///
    /// # Panics
    /// Panics if the face or one of its indices is out of range.
    pub fn triangle(&self, face: usize) -> [[f64; 3]; 3] {
        self.faces[face].map(|i| self.vertices[i as usize])
    }
}
