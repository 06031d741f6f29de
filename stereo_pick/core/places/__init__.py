"""Places: where an object is whose outlines are known in both views, as the solid that it is, or taken apart."""
