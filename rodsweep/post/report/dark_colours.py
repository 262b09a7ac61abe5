"""Colours of figures on a dark page: greys are inverted, and colours too dark for the page are lightened."""

INK = 232
"""Brightness of black ink on the dark page, from 0 to 255."""
PAPER = 27
"""Brightness, on the dark page, of what is white on the light page: the brightness of the dark page
itself."""
MIN_CONTRAST = 4.5
"""Contrast of a line with the page that WCAG 2 asks of text; it asks 3 of graphics, without thin lines."""
STEPS = 20
"""Number of steps from a colour to white."""


def in_the_dark(colour: str) -> str:
    """The dark page's colour for a colour of the light page; both are six hexadecimal digits."""
    parts = [int(colour[place : place + 2], 16) for place in (0, 2, 4)]
    if len(set(parts)) == 1:
        parts = [round(INK + (PAPER - INK) * part / 255) for part in parts]
    else:
        lighter = ([part + (255 - part) * step / STEPS for part in parts] for step in range(STEPS + 1))
        parts = next([round(part) for part in each] for each in lighter if _contrast(each) >= MIN_CONTRAST)
    return "".join(f"{part:02x}" for part in parts)


def _contrast(parts: list[float]) -> float:
    """Contrast ratio, as WCAG 2 defines it, of a lighter colour with the dark page."""
    return (_luminance(parts) + 0.05) / (_luminance([PAPER] * 3) + 0.05)


def _luminance(parts: list[float]) -> float:
    """Relative luminance, from 0 to 1, of red, green and blue from 0 to 255, as WCAG 2 defines it."""
    linear = [
        part / 255 / 12.92 if part <= 0.04045 * 255 else ((part / 255 + 0.055) / 1.055) ** 2.4
        for part in parts
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
