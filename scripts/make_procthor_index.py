"""Write assets/taxonomies/procthor_assets.csv from ProcTHOR's asset database.

For maintainers: `python scripts/make_procthor_index.py asset-database.json`, with the file
`procthor/databases/asset-database.json` of github.com/allenai/procthor (Apache-2.0). Only facts
are kept: each model's name, type and the size of its box in metres.
"""

from __future__ import annotations

import csv
import io
import sys
from pathlib import Path

from lcrl_bench.storage import read_json, write_bytes

TARGET = Path(__file__).parents[1] / "assets" / "taxonomies" / "procthor_assets.csv"


def main() -> None:
    """Read the database named on the command line and write the index."""
    database = read_json(Path(sys.argv[1]))
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["assetId", "objectType", "width", "depth", "height"])
    models = [model for models in database.values() for model in models]
    for model in sorted(models, key=lambda model: (model["objectType"], model["assetId"])):
        box = model["boundingBox"]
        # Unity's y is up, its z is the model's front.
        size = [f"{box[axis]:.4f}" for axis in "xzy"]
        writer.writerow([model["assetId"], model["objectType"], *size])
    write_bytes(TARGET, text.getvalue().encode())
    print(f"{TARGET}: {len(models)} models")


if __name__ == "__main__":
    main()
