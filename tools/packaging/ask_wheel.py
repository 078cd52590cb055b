"""Asks the question of the demo in Python, and one that needs the data of PROJ. Run by
tools/test_package.sh in the folder of the road; writes conflicts.csv with the points of each."""
import pathlib

import clearway

clearway.convert(["environment.las"], "site.h5")
poses = clearway.read_trajectory("trajectory.txt")
query = clearway.Query(clearway.read_model("model.ply"), poses, 0.1, first_pose=True)
clearway.search(clearway.Store("site.h5"), query, "result.h5")
conflicts = clearway.find_conflicts(clearway.Result("result.h5"), poses)
rows = [f"{conflict.points}\n" for conflict in conflicts.listed]
pathlib.Path("conflicts.csv").write_text("points\n" + "".join(rows))

places = clearway.read_trajectory("../places.csv", crs="EPSG:25832")
length = ((places[1, :3, 3] - places[0, :3, 3]) ** 2).sum() ** 0.5
print(f"clearway {clearway.__version__} of {clearway.__file__}; places {length:.3f} m apart")
