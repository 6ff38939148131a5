"""Makes the imports of a fork server as quick as those of a command: it imports this module first.

The processes of a pool are forked from that server, see ``own_pool``.
"""

from neurotouch_hid.process.startup import collect_rarely, hasten_pydantic, leave_out_asyncio

collect_rarely()
leave_out_asyncio()
hasten_pydantic()
