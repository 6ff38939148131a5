# Makes neurotouch@.service, another player's, of neurotouch.service.
s/^Description=.*/&, player %i/
s/^\(Runtime\|State\)Directory=.*/&-%i/
s/^Environment=NEUROTOUCH_PLAYER=.*/Environment=NEUROTOUCH_PLAYER=%i/
s/^# Started by the camera's udev rule.*/# Started with the machine once it is enabled; it waits for its camera./
# What one has compiled the next one finds.
s/^StartLimitIntervalSec=0/&\nAfter=neurotouch.service/
$a\
\
[Install]\
WantedBy=multi-user.target
