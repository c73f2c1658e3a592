"""Jobs: functions of JSON and files, done once, on processes of this machine or on a cluster."""
