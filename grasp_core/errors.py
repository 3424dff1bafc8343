"""The few exceptions of this project; every message says what was wrong and the way out."""


class GraspError(Exception):
    """Base of every error that a user can mend; its message is one clear line."""


class ConfigError(GraspError):
    """A configuration file or value is missing, misspelt, duplicated or ill-typed."""


class ImageError(GraspError):
    """A depth image or mask cannot be used: wrong shape, unit, type or content."""


class MeshError(GraspError):
    """A mesh or URDF cannot be read, repaired or decomposed."""


class MismatchError(GraspError):
    """Data or weights were made with another gripper, view or physics than the one in use."""


class StoreError(GraspError):
    """A dataset cannot be opened, read or written."""


class Cancelled(GraspError):
    """Long work was stopped by its user; what was finished is kept."""
