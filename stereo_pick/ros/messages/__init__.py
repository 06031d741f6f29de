"""Making and reading of every message type, one file a type; nodes set no message field themselves."""
