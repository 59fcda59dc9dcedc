//! Which of two meshes, a and b, is the host and which is the guest.

/// Which of two meshes is the host. The other mesh is the guest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Sides {
    is_second_host: bool,
}

impl Sides {
    /// The first mesh is the host.
    pub(crate) const FIRST_HOSTS: Self = Self { is_second_host: false };

    /// The second mesh is the host.
    pub(crate) const SECOND_HOSTS: Self = Self { is_second_host: true };

    /// Returns the values of host and guest, given those of the first and the second mesh.
    #[inline(always)]
    pub(crate) fn host_guest<T>(self, [a, b]: [T; 2]) -> [T; 2] {
        if self.is_second_host { [b, a] } else { [a, b] }
    }

    /// Returns the values of the first and the second mesh, given those of host and guest.
    #[inline(always)]
    pub(crate) fn first_second<T>(self, [host, guest]: [T; 2]) -> [T; 2] {
        if self.is_second_host { [guest, host] } else { [host, guest] }
    }

    /// Returns the sides with host and guest exchanged.
    #[inline(always)]
    pub(crate) fn exchanged(self) -> Self {
        Self { is_second_host: !self.is_second_host }
    }
}
