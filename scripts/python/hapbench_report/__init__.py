"""The report of hapbench: results, figures and claims become one self-contained HTML file with a replay."""
