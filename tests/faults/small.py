"""A small config of every task, and one with a list of points; each runs in a second or two."""

from .points import GOOD

POINTS = GOOD
CONFIGS = {
    "spectrum": """
title: spectra
task: spectrum
parameters: {F: {start: 0, stop: 60, num: 5}, k1: [100, 1.0e4], k2: 1.0e4, gamma3: 1.0e-4}
spectrum: {modes: 2, vectors: true, nodes: 5}
""",
    "list": """
title: a list
task: spectrum
parameters: {points: points.csv}
spectrum: {modes: 2}
""",
    "thresholds": """
task: thresholds
parameters: {k1: [200, 1.0e4], k2: [100, 1.0e4], gamma3: 1.0e-4}
thresholds: {crossings: 4, F_max: 60}
""",
    "phase_diagram": """
task: phase_diagram
parameters: {F: {start: 0, stop: 100, num: 5}, k1: [130, 140, 160], k2: 1.0e4, gamma3: 1.0e-4}
phase_diagram: {crossings: 4}
""",
    "modes": """
task: modes
parameters: {F: [10, 20, 30], k1: 1.0e4, k2: 1.0e2, gamma3: 1.0e-2}
modes: {nodes: 5}
""",
    "limit_cycle": """
task: limit_cycle
parameters: {F: [20, 40, 41], k1: 1.0e4, k2: 1.0e2, gamma3: 1.0e-2}
limit_cycle: {start: neighbour, samples: 8, shapes: 4, nodes: 5, harmonics: 2}
accuracy: 1.0e-3
""",
}
FURTHER = {
    "branch": """
task: branch
parameters: {k1: 150, k2: 1.0e4, gamma3: 1.0e-4}
branch: {stop: 80}
accuracy: 1.0e-4
""",
    "arm": """
task: modes
parameters: {arm: {length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 1 Pa s, pressure: 1 kPa}}
modes: {nodes: 5}
""",
}
"""Configs of what a loaded process needs beside: branches, and units."""
