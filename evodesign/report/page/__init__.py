"""The page of a run: one HTML file that needs no network.

`content` says what stands in the page; `gather` takes it from the log; `render` puts it, with plotly and the
files of `template/`, into one file. Everything that a browser computes (link poses from joint positions,
selections) it computes from these figures.
"""

from evodesign.report.page.gather import page_content
from evodesign.report.page.render import page_html

__all__ = ["page_content", "page_html"]
