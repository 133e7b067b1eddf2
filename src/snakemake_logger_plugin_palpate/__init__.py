"""Logger plugin of Snakemake: one line on the progress of a study, what is learnt, and its answer at the end.

`profiles/default` names it. Dry runs, and whatever is asked for with ``--verbose``, are shown as Snakemake shows them;
the complete log lies in ``.snakemake/log`` in any case.
"""

import logging
import sys
from typing import Any

from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from palpate.workflow_support.console import Console

NOTHING_TO_DO = "Nothing to be done"
SHOWN = (LogEvent.JOB_ERROR, LogEvent.GROUP_ERROR, LogEvent.ERROR)  # beside warnings, as Snakemake writes them


class LogHandler(LogHandlerBase):
    """Handler of the records of Snakemake's main process."""

    def __post_init__(self) -> None:
        """Begin a console where records would be written."""
        self.console = Console(sys.stdout if self.common_settings.stdout else sys.stderr)

    def emit(self, record: logging.LogRecord) -> None:
        """Tell the console of a record; what it cannot show never ends a study."""
        try:
            self._emit(record)
        except Exception:
            self.handleError(record)

    def _emit(self, record: Any) -> None:
        """Tell the console of a record, whose attributes beyond those of `logging` depend on its event."""
        event = getattr(record, "event", None)
        if (
            self.common_settings.dryrun
            or self.common_settings.verbose
            or event in SHOWN
            or record.levelno > logging.INFO
        ):
            self.console.write(self.format(record))
        elif event == LogEvent.RUN_INFO:
            self.console.planned({rule: count for rule, count in record.stats.items() if rule != "total"})
        elif event == LogEvent.JOB_INFO:
            self.console.started(record.jobid, record.rule_name, record.rule_msg or record.rule_name, record.output)
        elif event == LogEvent.JOB_FINISHED:
            self.console.finished(record.job_id)
        elif event == LogEvent.PROGRESS:
            self.console.counted(record.total)
            if record.done == record.total:
                self.console.done()
        elif event is None and str(record.msg).startswith(NOTHING_TO_DO):
            self.console.write(str(record.msg))
            self.console.done()

    @property
    def writes_to_stream(self) -> bool:
        """It takes the place of Snakemake's own handler."""
        return True

    @property
    def writes_to_file(self) -> bool:
        """It writes no file."""
        return False

    @property
    def has_filter(self) -> bool:
        """Snakemake's own filter is used."""
        return False

    @property
    def has_formatter(self) -> bool:
        """Snakemake's own formatter is used."""
        return False

    @property
    def needs_rulegraph(self) -> bool:
        """It needs none."""
        return False
