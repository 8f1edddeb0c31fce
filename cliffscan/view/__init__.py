"""`cliffscan view`: a page in a browser that shows one robot, made for the question why it stopped."""
