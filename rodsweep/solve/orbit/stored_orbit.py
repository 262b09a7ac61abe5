"""An orbit as named arrays, for checkpoints."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...arrays import Array
from ...discretization.stress.form import StressForm
from ...model.material.rod_material import RodMaterial
from ...model.parameters import PARAMETERS
from ...model.rod import Rod
from .orbit import Orbit
from .orbit_mesh import OrbitMesh, mesh_of_orbit
from .symmetry import NO_SYMMETRY, REFLECTION


def orbit_arrays(orbit: Orbit) -> dict[str, Array]:
    """The orbit as arrays by name. "rod": values of the rod's parameters, in the order of `Rod.values`.
    "build": its material as JSON text, in UTF-8, (bytes,). "symmetric": whether the orbit is symmetric.
    "mesh": `OrbitMesh.as_array`. "orbit": `Orbit.values`, (N,)."""
    return {
        "rod": np.array(list(orbit.form.rod.values.values())),
        # Checkpoints hold arrays only, so a text is stored as its bytes.
        "build": np.frombuffer(orbit.form.rod.material.json_text.encode(), np.uint8),
        "symmetric": np.array(orbit.is_symmetric),
        "mesh": mesh_of_orbit(orbit).as_array,
        "orbit": orbit.values,
    }


def orbit_from_arrays(arrays: Mapping[str, Array], is_omega_always_unknown: bool = False) -> Orbit:
    """The orbit from named arrays with the shapes that `orbit_arrays` gives, for example "orbit", (N,).
    is_omega_always_unknown: option of the orbit's `StressForm`."""
    mesh = OrbitMesh.from_array(arrays["mesh"])
    parameters: dict[str, Any] = dict(zip(PARAMETERS, map(float, arrays["rod"]), strict=True))
    rod = Rod(**parameters, material=RodMaterial.from_json_text(bytes(arrays["build"]).decode()))
    form = StressForm(rod, mesh.space_mesh, is_omega_always_unknown)
    symmetry = REFLECTION if arrays["symmetric"] else NO_SYMMETRY
    return Orbit(form, symmetry, mesh.interval_count, mesh.stage_count, arrays["orbit"], mesh.grading)
