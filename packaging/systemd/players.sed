# Makes neurotouch@.service, another player's, of neurotouch.service.
s/^Description=.*/&, player %i/
s/^\(Runtime\|State\)Directory=.*/&-%i/
s/^Environment=XDG_CONFIG_HOME=.*/& NEUROTOUCH_PLAYER=%i/
s/^# Started by the camera's udev rule.*/# Started with the machine once it is enabled; it waits for its camera./
$a\
\
[Install]\
WantedBy=multi-user.target
