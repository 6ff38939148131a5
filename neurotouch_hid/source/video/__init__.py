"""Pictures of an ordinary camera, from V4L2 or from a video file, as slices of sensor time."""
