"""What the paper (see README.md) reports of its own data sets and machines, in our words."""

# Table 1 by the scene like it: points, model points, poses, colliding points on the CPU (double)
# and on the GPU (float).
TABLE = {
    "mine": ("El Teniente", 806183400, 100000, 17795, 35225149, 35225399),
    "hall": ("Hannover", 55872714, 214489, 17234, 2495803, 2495804),
    "plant": ("Wolfsburg", 350109065, 434700, 398999, 26089196, 26089208),
    "tunnel": ("Train Tunnel", 18919000, 28622, 19392, 1627225, 1627233),
}

THREADS = """Fig. 1 (Hannover, 3DTK's k-d tree on 20 cores of two Xeon E5-2680 v2): speed grows \
linearly with the threads up to the number of cores.
With hyper-threading it grows on, less steeply, to about 1.2 times at 40 threads (17.3 % more).
Beyond the number of virtual cores nothing is gained."""

GRID = """Fig. 2 (Hannover, GPU method by grid resolution, stacked time of its steps, number of \
cells as a line):
Many cells make building the grid dearer, but it stays below 5 % of the time.
Most time goes into the search for neighbours.
Time grows with the size of a grid cell, and fluctuates much: slightly different decompositions \
bring different numbers of cells to the GPU.
It wishes for a heuristic that picks the cell size."""

ENGINES = """Fig. 3 (k-d tree on 8 and on 20 cores with all their threads; grid on Titan X, GTX \
980 and Tesla K40, grid size 50; search time only):
Which is ahead depends on the data set.
Wolfsburg (plant): the grid on the Titan X is the fastest.
Train Tunnel (tunnel): the k-d tree on 20 cores is far ahead of every GPU.
El Teniente (mine) and Train Tunnel are mostly empty space: a regular grid has many empty cells, \
and the others cover too much.
Wolfsburg takes longest of all."""

POINTS = """Fig. 4 (Hannover, 111 random samples of 0.5 to 55.5 million points; k-d tree on 20 cores, \
grid on a Titan X):
The time of both is nearly linear in the number of points, with perhaps a very shallow logarithm \
beneath; the paper leaves that open."""
