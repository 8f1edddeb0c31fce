"""What goes over the wire: messages, topics, and what they are made of. It imports nothing else of cliffscan."""
