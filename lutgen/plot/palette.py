"""Palette: the colours of all figures, and what each stands for."""

# Okabe and Ito's palette, which stays distinct for colour-blind readers.  A colour is a thing, in
# all figures: green is support and what any posture can do, red is tip-over, orange is sliding,
# blue is what a figure is about; red lines are thicker, too, for those who do not see red.
BLUE, ORANGE, GREEN, GREY = "#0072B2", "#D55E00", "#009E73", "#595959"
PURPLE, SKY, RED = "#CC79A7", "#56B4E9", "#C8102E"
WASH = "#f0f0f0"
HATCH = "/////"
# What has an ink of its own, because it lies on a colour scale.
ON_COLOURS = "on colours"
# Viridis is perceptually even, also for colour-blind readers and in grey.
MAP = "viridis"
