"""Sources of pictures alone: video clips and cameras that give no events."""
