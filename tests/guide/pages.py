"""What the test of the guide has to know of its pages: how each is run, what is not, and the files at hand."""

# A page that is followed from top to bottom runs in one folder, which is empty or has the files that
# stand_ins.py makes. Of any other page each block runs by itself, in a folder with these files.
FOLLOWED_FROM_NOTHING = {"docs/guide/tutorial.md", "docs/guide/campaigns.md", "docs/guide/ledger.md"}
FOLLOWED = {"docs/guide/section.md", "docs/guide/vehicles.md", "docs/guide/recipes.md"}

# What schedulers set in a job, here for the first task of a campaign.
OF_SCHEDULERS = {"JOB_COMPLETION_INDEX": "0", "AWS_BATCH_JOB_ARRAY_INDEX": "0", "PBS_ARRAY_INDEX": "0",
                 "PBS_ARRAYID": "0", "SGE_TASK_ID": "1", "LSB_JOBINDEX": "1"}

# (page, beginning of the command): why the test does not run it.
NOT_RUN = {
    ("README.md", "tools/demo.sh"): "builds the program, and runs a check as the first command of the page",
    ("README.md", "tools/test.sh"): "runs all tests",
    ("README.md", "clearway check demo/road"): "reads what the demo makes",
    ("README.md", "export PATH="): "the test names the program",
    ("README.md", "source <(tools/completion.py"): "the test completion does, in both shells",
    ("README.md", "cmake --preset release &&"): "builds the program and runs all tests",
    ("docs/guide/tutorial.md", "git clone"): "gets the sources",
    ("docs/guide/tutorial.md", "cd clearway"): "the test begins in its own folder",
    ("docs/guide/tutorial.md", "tools/demo.sh"): "builds the program",
    ("docs/guide/tutorial.md", "export PATH="): "the test names the program",
    ("docs/guide/tutorial.md", "mkdir demo/tutorial"): "the test begins in its own folder",
    ("docs/guide/tutorial.md", "cd demo/tutorial"): "the test begins in its own folder",
    ("docs/guide/campaigns.md", "spring/submit.sh"): "needs Slurm; the test slurm submits campaigns",
    ("docs/guide/command-line.md", "source <(tools/completion.py"): "the test completion does, in both shells",
    ("docs/guide/library.md", "cmake"): "builds the library; the test installed_library installs it",
    ("docs/guide/measuring.md", "tools/evaluate.sh"): "measures for minutes",
    ("docs/guide/measuring.md", "tools/experiments.py"): "makes scenes of 800 million points",
    ("docs/guide/python.md", "clearway scene"): "the test python_guide runs it, with the page's snippets",
    ("docs/guide/whatif.md", "clearway scene"): "the test python_whatif runs it, with the page's snippets",
}

# (page, beginning of the snippet): which other test runs it, or why none does.
SNIPPETS_ELSEWHERE = {
    ("README.md", "#include"): "the test installed_library builds and runs it",
    ("docs/guide/library.md", "cmake_minimum_required"): "the test installed_library builds with it",
    ("docs/guide/library.md", "#include"): "the test installed_library compiles it, and runs the one with main",
    ("docs/guide/python.md", ""): "the test python_guide runs it",
    ("docs/guide/section.md", "import clearway"): "the test python_section runs it",
    ("docs/guide/whatif.md", ""): "the test python_whatif runs it",
    ("docs/guide/campaigns.md", '"vehicles"'): "a part of a campaign's file, with folders of models",
}

# (page, beginning of the text): why it is not the output of the commands above it.
SAMPLES = {
    ("README.md", "2 conflicts of 6,128"): "of the demo, tools/demo.sh",
    ("docs/guide/results.md", "conflict: 1,204"): "of a trajectory with names and times",
    ("docs/guide/results.md", "conflict: 60 points"): "of a scan with classes",
}

# (page, beginning of a snippet): the file that the page tells the reader to write.
WRITTEN = {
    ("docs/guide/campaigns.md", "{"): "campaign.json",
    ("docs/guide/vehicles.md", '{"bodies": [\n  {"name": "body"'): "wagon.json",
    ("docs/guide/vehicles.md", '{"bodies": [\n  {"name": "tractor"'): "road.json",
    ("docs/guide/recipes.md", "x,y\n0,0"): "inner.csv",
    ("docs/guide/recipes.md", "x,y\n0,-3.4"): "outer.csv",
    ("docs/guide/recipes.md", "height,half_width"): "train.csv",
    ("docs/guide/section.md", "y,z\n-0.6"): "load.csv",
    ("docs/guide/section.md", "y,z\n-0.7"): "curve.csv",
    ("docs/guide/section.md", "chainage_from"): "outlines.csv",
}

# (page, beginning of the command): the exit code, where it is not 0.
EXIT_CODES = {
    ("README.md", "clearway compare"): 1,
    ("docs/guide/command-line.md", "clearway compare before.h5"): 1,
    ("docs/guide/section.md", "clearway section check section.h5 --table"): 1,
    ("docs/guide/results.md", "clearway compare before.h5"): 1,
}

# (page, as it stands in a command): what the test has in its place, so that it ends in a second.
SMALLER = {
    ("docs/guide/command-line.md", "--points 5000000"): "--points 20000",
    ("docs/guide/command-line.md", "scene mine -o mine"): "scene mine -o mine --points 20000 --poses 50",
}
