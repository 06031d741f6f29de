"""Finding the objects in each view: segmentation (thesis 3.7.2) and silhouettes."""

from stereo_pick.core.objects.blob import Blob, Blobs
from stereo_pick.core.objects.detector import Detector

__all__ = ["Blob", "Blobs", "Detector"]
