"""The method ``paper``: outliers of a homography, local maxima, a similarity."""
