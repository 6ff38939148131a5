"""The method of the paper: outliers of a homography, local maxima, a similarity."""
