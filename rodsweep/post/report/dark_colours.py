"""Colours of figures on a dark page: greys are inverted, and colours that are too dark are lightened."""

INK_BRIGHTNESS = 232
"""Brightness, from 0 to 255, of the grey that replaces black on the dark page."""
PAPER_BRIGHTNESS = 27
"""Brightness, from 0 to 255, of the grey that replaces white on the dark page, equal to the background."""
MIN_CONTRAST = 4.5
"""Smallest contrast ratio of a colour with the dark page. WCAG 2 requires 4.5 for text and 3 for graphics;
thin lines get the ratio for text."""
LIGHTENING_STEP_COUNT = 20
"""Number of steps between a colour and white that are tried when the colour is lightened."""


def dark_page_colour(colour: str) -> str:
    """Colour that replaces `colour` on the dark page. Colours are texts of six hexadecimal digits."""
    parts = [int(colour[start : start + 2], 16) for start in (0, 2, 4)]
    if len(set(parts)) == 1:
        parts = [round(INK_BRIGHTNESS + (PAPER_BRIGHTNESS - INK_BRIGHTNESS) * part / 255) for part in parts]
    else:
        lighter = (
            [part + (255 - part) * step / LIGHTENING_STEP_COUNT for part in parts]
            for step in range(LIGHTENING_STEP_COUNT + 1)
        )
        parts = next([round(part) for part in each] for each in lighter if _contrast(each) >= MIN_CONTRAST)
    return "".join(f"{part:02x}" for part in parts)


def _contrast(parts: list[float]) -> float:
    """Contrast ratio, as defined by WCAG 2, of a colour with the background of the dark page. parts: red,
    green and blue, from 0 to 255.
    """
    return (_luminance(parts) + 0.05) / (_luminance([PAPER_BRIGHTNESS] * 3) + 0.05)


def _luminance(parts: list[float]) -> float:
    """Relative luminance, from 0 to 1, as defined by WCAG 2. parts: red, green and blue, from 0 to 255."""
    linear = [
        part / 255 / 12.92 if part <= 0.04045 * 255 else ((part / 255 + 0.055) / 1.055) ** 2.4
        for part in parts
    ]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
