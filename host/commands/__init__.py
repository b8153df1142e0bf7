"""One verb a module: HELP, add_arguments(parser) and run(options), which returns the exit status."""
