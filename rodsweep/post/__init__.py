"""From result files to summaries and figures. The only importer of matplotlib; knows no solver."""
