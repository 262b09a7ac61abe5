"""The keys of an arm that tapers, has segments or is of rubber, in a config: what is taken, each refusal."""

import pytest

from rodsweep.config import read_config
from rodsweep.config.document.reading import config_from_resolved, config_yaml, resolved_config
from rodsweep.errors import InputError

ROUND = "length: 12 cm, radius: 6 mm, young: 100 kPa, viscosity: 50 Pa s"
CAST = 'young: 100 kPa, viscosity: 50 Pa s, segments: ["5 cm: radius 6 mm", {length: 7 cm, radius: 4 mm}]'
RUBBER = "law: neo_hookean, section: swelling"


def config(directory, arm, more="", beside="", task="thresholds"):
    path = directory / "arm.yaml"
    path.write_text(f"task: {task}\nparameters: {{arm: {{{arm}}}{beside}}}\n{more}\n")
    return read_config(path)[0]


@pytest.mark.parametrize(
    "arm",
    [
        f"{ROUND}, tip_radius: 3 mm",
        f"{ROUND}, tip_radius: [3 mm, 6 mm], {RUBBER}",
        CAST,
        f"{CAST}, {RUBBER}",
        CAST.replace("100 kPa", "[100 kPa, 200 kPa]"),
    ],
)
def test_an_arm_that_varies_is_read_again_from_its_file_and_its_text(tmp_path, arm):
    read = config(tmp_path, arm)
    again = config_from_resolved(resolved_config(read))
    (tmp_path / "text.yaml").write_text(config_yaml(read))
    for other in (again, read_config(tmp_path / "text.yaml")[0]):
        assert other.rod_material == read.rod_material
        assert other.settings_of_results == read.settings_of_results
        assert other.parameter_names == read.parameter_names
    assert not read.is_uniform_and_linear


def test_segments_make_the_length_in_their_unit(tmp_path):
    arm = config(tmp_path, CAST).parameters.arm
    assert arm.length.array().tolist() == pytest.approx([0.12])
    assert arm.length.written == "12 cm"
    assert config(tmp_path, f"{CAST}, length: 12 cm").rod_material == config(tmp_path, CAST).rod_material


def test_an_arm_alike_all_along_is_standard(tmp_path):
    assert config(tmp_path, f"{ROUND}, tip_radius: 6 mm, law: linear").is_uniform_and_linear
    alike = CAST.replace("4 mm", "6 mm")
    assert config(tmp_path, alike).is_uniform_and_linear
    assert config(tmp_path, f"{alike}, pressure: 1 kPa", task="limit_cycle").is_uniform_and_linear


@pytest.mark.parametrize(
    ("arm", "more", "beside", "sentence"),
    [
        (f"{ROUND}, tip_radius: 0", "", "", "parameters.arm.tip_radius = 0 m is not above 0"),
        (
            f"{ROUND}, inner_radius: {{start: 0, stop: 1 mm, num: 3}}",
            "",
            "",
            "parameters.arm.inner_radius = 0 m is not above 0; leave it out for a solid arm",
        ),
        (
            f"{ROUND}, tip_radius: 3 mm",
            "",
            ", taper: 0.5",
            "parameters.arm.tip_radius and parameters.taper are",
        ),
        (CAST, "", ", taper: 0.5", "parameters.arm.segments and parameters.taper are both given"),
        (
            f"{ROUND}, law: hooke",
            "",
            "",
            "parameters.arm.law = 'hooke' is not allowed; it should be linear or",
        ),
        (
            f"{ROUND}, section: swelling",
            "",
            "",
            "parameters.arm.section = swelling is not known for law = linear",
        ),
        (f"{ROUND}, {RUBBER}, poisson: 0.4", "", "", "parameters.arm.poisson = 0.4 contradicts section"),
        (
            f"{ROUND}, poisson: [0.4, 0.5]",
            "material: {law: neo_hookean, section: swelling}",
            "",
            "parameters.arm.poisson = 0.4 contradicts section = swelling",
        ),
        (
            f"{ROUND}, {RUBBER}",
            "material: {law: neo_hookean}",
            "",
            "material and parameters.arm.law are both given; give law and section in parameters.arm",
        ),
        (
            f"{ROUND}, tip_radius: 3 mm",
            "material: {law: neo_hookean}",
            "",
            "material and parameters.arm.tip_radius are both given",
        ),
        (
            'young: 100 kPa, viscosity: 50 Pa s, segments: ["5 cm: radius 6 mm", "20 nm: radius 4 mm"]',
            "",
            "",
            "segments, number 2: the length is 4e-07 of the arm's length; it must be at least 1e-06",
        ),
        (
            f"{CAST}, length: 11 cm",
            "",
            "",
            "parameters.arm.length = 0.11 m is not the sum of the segment lengths",
        ),
        (
            f"{CAST}, length: [11 cm, 12 cm]",
            "",
            "",
            "parameters.arm.length has several values, but the segments fix the length; leave it out",
        ),
        (f"{CAST}, radius: 6 mm", "", "", "parameters.arm.radius = 0.006 m and segments are both given"),
        (
            CAST.replace("radius: 4 mm", "radios: 4 mm"),
            "",
            "",
            "parameters.arm.segments, number 2: unknown key radios; a segment has",
        ),
        (
            CAST.replace("5 cm: radius 6 mm", "5 cm"),
            "",
            "",
            "parameters.arm.segments, number 1: '5 cm' is no",
        ),
        (CAST.replace("young: 100 kPa, ", ""), "", "", "parameters.arm.segments, number 1: young is missing"),
        ("radius: 6 mm, young: 100 kPa, viscosity: 1 Pa s", "", "", "parameters.arm.length is missing"),
    ],
)
def test_bad_shapes_are_refused(tmp_path, arm, more, beside, sentence):
    with pytest.raises(InputError, match=sentence) as refused:
        config(tmp_path, arm, more, beside)
    assert "\n" not in str(refused.value)


def test_profiles_that_differ_along_an_axis_of_one_parameter_are_refused(tmp_path):
    """Poisson's ratio is an axis of k2, and changes the shear of a tube and of solid segments otherwise."""
    tube = CAST.replace("radius 6 mm", "radius 6 mm, inner_radius 3 mm")
    with pytest.raises(InputError, match=r"parameters\.arm\.poisson has several values, and the ratios"):
        config(tmp_path, f"{tube}, poisson: [0.4, 0.5]")
    assert config(tmp_path, f"{CAST}, poisson: [0.4, 0.5]").rod_material.profile
