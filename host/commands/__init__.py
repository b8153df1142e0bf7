"""One verb a module: HELP, add_arguments(parser), and run(options) -> exit status."""
